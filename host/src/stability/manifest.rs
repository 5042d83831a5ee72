//! The manifest: what is expected, as it was written down.

use super::measure::Method;
use serde_json::Value;

/// A scene at which a method breaks.
#[derive(Clone, Debug)]
pub struct Case {
    /// Its name.
    pub name: String,
    /// What is hard about it.
    pub about: String,
    /// The file in `scenes/stability`, without `.xml`.
    pub scene: String,
    /// What the program adds to it, by name; see [`super::build`].
    pub added: Option<String>,
    /// Values for `$names` in the scene.
    pub defines: Vec<(String, String)>,
    /// Samples per pixel in a run with factor 1.
    pub samples: u64,
    /// What comes out where nothing is wrong.
    pub truth: Truth,
    /// What each estimator is expected to do.
    pub expected: Vec<Expected>,
}

/// A number to be met: the mean radiance of the image.
#[derive(Clone, Debug)]
pub struct Truth {
    /// By channel; scenes without colour have one number.
    pub value: Vec<f64>,
    /// How far it may be off, relative.
    pub uncertainty: f64,
    /// Where it comes from.
    pub source: String,
}

/// What is expected of an estimator.
#[derive(Clone, Debug)]
pub struct Expected {
    /// Which.
    pub method: Method,
    /// What it does.
    pub what: Expectation,
    /// Why, in a line.
    pub why: String,
    /// Samples relative to the case's.
    pub factor: f64,
}

/// What an estimator does with a case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Expectation {
    /// Its mean is the truth.
    Right,
    /// It can't make all light paths: too dark, and the program names them.
    Misses,
    /// Right in expectation, but few samples carry it all: variance is infinite or all but infinite.
    Heavy,
    /// It refuses the scene, with a reason.
    Refused,
    /// A documented approximation: off by no more than this, relative.
    Biased(f64),
}

const MANIFEST: &str = include_str!("../../scenes/stability/manifest.json");

/// What is written down.
///
/// # Errors
/// Where it can't be read; a test holds that it can.
pub fn manifest() -> Result<Vec<Case>, String> {
    parse(MANIFEST).map_err(|e| format!("manifest.json: {e}"))
}

fn parse(text: &str) -> Result<Vec<Case>, String> {
    let all: Value = serde_json::from_str(text).map_err(|e| e.to_string())?;
    let cases = all.as_array().ok_or("expected a list of cases")?;
    cases.iter().map(case).collect()
}

fn text(v: &Value, key: &str) -> Result<String, String> {
    let found = v[key].as_str().map(str::to_owned);
    found.ok_or_else(|| format!("{v}: expected a text \"{key}\""))
}

fn case(v: &Value) -> Result<Case, String> {
    let name = text(v, "name")?;
    let at = |e: String| format!("{name}: {e}");
    let truth = &v["truth"];
    let value = match &truth["value"] {
        Value::Array(channels) => channels.iter().filter_map(Value::as_f64).collect(),
        other => other.as_f64().into_iter().collect::<Vec<_>>(),
    };
    if ![1, 3].contains(&value.len()) {
        return Err(at("truth: expected one number, or three".into()));
    }
    let defines = v["defines"].as_object().into_iter().flatten();
    let expected = v["expected"].as_object().into_iter().flatten();
    Ok(Case {
        about: text(v, "about").map_err(at)?,
        scene: text(v, "scene").unwrap_or_else(|_| name.clone()),
        added: v["added"].as_str().map(str::to_owned),
        defines: defines
            .map(|(k, v)| (k.clone(), v.as_str().unwrap_or("").to_owned()))
            .collect(),
        samples: v["samples"].as_u64().unwrap_or(64),
        truth: Truth {
            value,
            uncertainty: truth["uncertainty"].as_f64().unwrap_or(1e-6),
            source: text(truth, "source").map_err(at)?,
        },
        expected: expected
            .map(|(method, e)| expectation(method, e).map_err(at))
            .collect::<Result<_, _>>()?,
        name,
    })
}

fn expectation(method: &str, v: &Value) -> Result<Expected, String> {
    let what = text(v, "outcome")?;
    let what = match what.split_once(' ') {
        None => match what.as_str() {
            "right" => Expectation::Right,
            "misses" => Expectation::Misses,
            "heavy" => Expectation::Heavy,
            "refused" => Expectation::Refused,
            _ => return Err(format!("unknown outcome {what:?}")),
        },
        Some(("biased", bound)) => match bound.parse() {
            Ok(bound) => Expectation::Biased(bound),
            Err(_) => return Err(format!("expected a number after biased, found {bound:?}")),
        },
        Some(_) => return Err(format!("unknown outcome {what:?}")),
    };
    Ok(Expected {
        method: Method::of(method).ok_or_else(|| format!("unknown estimator {method:?}"))?,
        what,
        why: text(v, "why")?,
        factor: v["factor"].as_f64().unwrap_or(1.0),
    })
}

impl std::fmt::Display for Expectation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Right => f.write_str("right"),
            Self::Misses => f.write_str("misses"),
            Self::Heavy => f.write_str("heavy"),
            Self::Refused => f.write_str("refused"),
            Self::Biased(bound) => write!(f, "biased {bound}"),
        }
    }
}
