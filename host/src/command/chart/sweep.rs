//! What variants of a chart differ in: flags of the command line, put in by turns.

use crate::command::how::How;
use crate::command::reading::Reading;
use clap::{Args, FromArgMatches};
use std::ffi::OsString;

/// What variants differ in.
#[derive(Args, Debug)]
pub struct Variant {
    #[command(flatten)]
    pub how: How,
    #[command(flatten)]
    pub reading: Reading,
    /// Precision that light is estimated in
    #[arg(long, value_enum, default_value_t = PrecisionName::Single)]
    precision: PrecisionName,
}

#[derive(Clone, Copy, Debug, PartialEq, clap::ValueEnum)]
enum PrecisionName {
    /// f32
    Single,
    /// f64, by the same source
    Double,
}

impl Variant {
    /// Whether in double precision.
    pub fn double(&self) -> bool {
        self.precision == PrecisionName::Double
    }
}

/// A flag and the values that it takes in turn.
#[derive(Clone, Debug)]
pub struct Sweep {
    pub key: String,
    pub values: Vec<String>,
}

/// `KEY=V1,V2`.
pub fn sweep(text: &str) -> Result<Sweep, String> {
    let expected = || format!("expected KEY=V1,V2,… where --KEY is a flag, found {text:?}");
    let (key, values) = text.split_once('=').ok_or_else(expected)?;
    let separator = if values.contains(';') { ';' } else { ',' };
    let values: Vec<String> = values.split(separator).map(|v| v.trim().into()).collect();
    if key.is_empty() || values.iter().any(String::is_empty) {
        return Err(expected());
    }
    Ok(Sweep {
        key: key.trim_start_matches('-').into(),
        values,
    })
}

/// The flags of variants alone.
fn flags() -> clap::Command {
    // What comes later replaces what was there.
    Variant::augment_args(
        clap::Command::new("chart")
            .no_binary_name(true)
            .args_override_self(true),
    )
}

/// The variant that the command line asks for, with these flags put in.
pub fn variant(line: &[OsString], changes: &[(String, String)]) -> Result<Variant, String> {
    let command = flags();
    let mut all: Vec<OsString> = line.to_vec();
    for (key, value) in changes {
        let argument = command.get_arguments().find(|a| a.get_long() == Some(key));
        let Some(argument) = argument.filter(|a| a.get_id() != "define") else {
            let known: Vec<_> = command
                .get_arguments()
                .filter_map(|a| a.get_long())
                .collect();
            return Err(format!(
                "--sweep {key}: expected one of {}",
                known.join(", ")
            ));
        };
        match (argument.get_action(), value.as_str()) {
            (clap::ArgAction::SetTrue, "true") => all.push(format!("--{key}").into()),
            (clap::ArgAction::SetTrue, "false") => all.retain(|a| *a != *format!("--{key}")),
            (clap::ArgAction::SetTrue, _) => {
                return Err(format!("--sweep {key}={value}: expected true or false"));
            }
            _ => all.push(format!("--{key}={value}").into()),
        }
    }
    let matches = command.try_get_matches_from(all);
    matches
        .and_then(|m| Variant::from_arg_matches(&m))
        .map_err(|e| {
            let text = e.to_string();
            let text = text.split("\n\n").next().unwrap_or_default();
            text.trim_start_matches("error: ").into()
        })
}

/// Of the arguments of the whole program, those that [`Variant`] knows: they are parsed again for each variant.
pub fn own(arguments: impl Iterator<Item = OsString>) -> Vec<OsString> {
    let command = flags();
    let known = |name: &str| {
        command.get_arguments().find(|a| {
            name.strip_prefix("--")
                .is_some_and(|n| a.get_long() == Some(n))
                || name
                    .strip_prefix('-')
                    .is_some_and(|n| a.get_short().is_some_and(|s| n == s.to_string()))
        })
    };
    let mut mine = Vec::new();
    let mut arguments = arguments.peekable();
    while let Some(argument) = arguments.next() {
        let text = argument.to_string_lossy().into_owned();
        let name = text.split('=').next().unwrap_or_default();
        if text.starts_with("-D") && text.len() > 2 {
            mine.push(argument);
        } else if let Some(found) = known(name) {
            let takes = matches!(
                found.get_action(),
                clap::ArgAction::Set | clap::ArgAction::Append
            );
            mine.push(argument);
            if takes && !text.contains('=') {
                mine.extend(arguments.next());
            }
        }
    }
    mine
}

/// All combinations.
pub fn product(sweeps: &[Sweep]) -> Vec<Vec<(String, String)>> {
    sweeps.iter().fold(vec![Vec::new()], |all, sweep| {
        let longer = |before: &Vec<(String, String)>| {
            let before = before.clone();
            sweep.values.iter().map(move |value| {
                let mut changes = before.clone();
                changes.push((sweep.key.clone(), value.clone()));
                changes
            })
        };
        all.iter().flat_map(longer).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::{own, product, sweep, variant};
    use std::ffi::OsString;

    fn line(text: &str) -> Vec<OsString> {
        text.split_whitespace().map(Into::into).collect()
    }

    #[test]
    fn sweeps_multiply() {
        let all = product(&[sweep("a=1,2").unwrap(), sweep("b=x;y,z;w").unwrap()]);
        assert_eq!(all.len(), 6);
        assert_eq!(
            all[1],
            [("a".into(), "1".into()), ("b".into(), "y,z".into())]
        );
        assert!(sweep("a").is_err() && sweep("a=").is_err() && sweep("=b").is_err());
    }

    #[test]
    fn variants_take_the_command_lines_flags_and_their_own() {
        let mine = own(line(
            "scene.xml --mis balance -o x.html --seed=3 --budget 3s -D a=b -Dc=d --shift",
        )
        .into_iter());
        assert_eq!(mine, line("--mis balance --seed=3 -D a=b -Dc=d --shift"));
        let v = variant(
            &mine,
            &[
                ("mis".into(), "maximum".into()),
                ("shift".into(), "false".into()),
            ],
        )
        .unwrap();
        let s = v.how.settings(None);
        assert_eq!(
            (s.heuristic, s.seed, s.rule.shift),
            (etendue::Heuristic::Maximum, 3, false)
        );
        assert_eq!(v.reading.define.len(), 2);
        for (key, value) in [
            ("mis", "best"),
            ("nonsense", "1"),
            ("shift", "perhaps"),
            ("seed", "-1"),
        ] {
            let e = variant(&mine, &[(key.into(), value.into())]).unwrap_err();
            assert!(e.contains(key) || e.contains(value), "{e}");
        }
    }
}
