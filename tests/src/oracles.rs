//! Numbers to be met: `tests/data/oracles.json`.

use serde_json::Value;

/// One number.
#[derive(Clone, Debug)]
pub struct Oracle {
    /// Its name.
    pub id: String,
    /// Its value in exact arithmetic.
    pub value: f64,
    /// Absolute uncertainty of the value.
    pub uncertainty: f64,
    record: Value,
}

impl Oracle {
    /// The parameter `name`.
    pub fn parameter(&self, name: &str) -> f64 {
        self.record[name]
            .as_f64()
            .unwrap_or_else(|| panic!("{}: no {name}", self.id))
    }
}

/// The numbers whose problem is `problem` and whose id begins with `id`.
pub fn oracles(problem: &str, id: &str) -> Vec<Oracle> {
    let all: Value =
        serde_json::from_str(include_str!("../data/oracles.json")).expect("valid JSON");
    let found: Vec<_> = all
        .as_array()
        .expect("an array")
        .iter()
        .filter(|record| record["problem"] == problem)
        .filter_map(|record| {
            Some(Oracle {
                id: record["id"].as_str().filter(|s| s.starts_with(id))?.into(),
                value: record["value"].as_f64()?,
                uncertainty: record["uncertainty"].as_f64()?,
                record: record.clone(),
            })
        })
        .collect();
    assert!(!found.is_empty(), "no oracle {problem}/{id}…");
    found
}
