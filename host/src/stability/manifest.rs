//! The manifest: what is expected, as it was written down.

use super::estimators;
use etendue::Estimator;
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
    pub estimator: Estimator,
    /// What it does.
    pub what: Expectation,
    /// What of the same random numbers is right where this is biased, if anything.
    pub beside: Option<Beside>,
    /// Why, in a line.
    pub why: String,
    /// What a warning of the program says about it: the cure.
    pub warns: Option<String>,
    /// Samples relative to the case's.
    pub factor: f64,
    /// How far f32 may be off from f64, relative, where that isn't what is expected.
    pub rounding: f64,
}

/// Relative difference of f32 and f64 that is rounding.
const ROUNDING: f64 = 1e-4;

/// What a bias is seen against: the same random numbers without what makes it, which shows far smaller ones than the truth does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beside {
    /// Double precision.
    Double,
    /// The scene without what the program adds to it.
    Plain,
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
    /// A documented approximation: off by so much, relative.
    Biased {
        /// By how much.
        by: f64,
        /// How far that may be off itself.
        within: f64,
    },
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

fn expectation(name: &str, v: &Value) -> Result<Expected, String> {
    let what = text(v, "outcome")?;
    let what = match what.as_str() {
        "right" => Expectation::Right,
        "misses" => Expectation::Misses,
        "heavy" => Expectation::Heavy,
        "refused" => Expectation::Refused,
        other => biased(other).ok_or_else(|| {
            format!("expected right, misses, heavy, refused or a text like \"biased -0.05 within 0.01\", found {what:?}")
        })?,
    };
    let beside = match (v["beside"].as_str(), what) {
        (None, _) => None,
        (Some("f64"), Expectation::Biased { .. }) => Some(Beside::Double),
        (Some("plain"), Expectation::Biased { .. }) => Some(Beside::Plain),
        (Some(other), _) => {
            return Err(format!(
                "beside {other:?}: expected \"f64\" or \"plain\", of a bias"
            ));
        }
    };
    let estimator = estimators().find(|(_, n)| n == name);
    Ok(Expected {
        estimator: estimator
            .ok_or_else(|| format!("unknown estimator {name:?}"))?
            .0,
        what,
        beside,
        why: text(v, "why")?,
        warns: v["warns"].as_str().map(str::to_owned),
        factor: v["factor"].as_f64().unwrap_or(1.0),
        rounding: v["rounding"].as_f64().unwrap_or(ROUNDING),
    })
}

/// `biased -0.05 within 0.01`.
fn biased(text: &str) -> Option<Expectation> {
    let numbers = text.strip_prefix("biased ")?;
    let (by, within) = numbers.split_once(" within ")?;
    let (by, within) = (by.parse().ok()?, within.parse().ok()?);
    Some(Expectation::Biased { by, within })
}

impl std::fmt::Display for Expectation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Right => f.write_str("right"),
            Self::Misses => f.write_str("misses"),
            Self::Heavy => f.write_str("heavy"),
            Self::Refused => f.write_str("refused"),
            Self::Biased { by, within } => write!(f, "biased {by:+} ± {within}"),
        }
    }
}
