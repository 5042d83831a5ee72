//! The atlas's results: a table for a terminal, one page for a browser.

use super::judge::Row;
use super::manifest::Expectation;
use super::{FALSE_ALARM, Ready};
use std::fmt::Write;

/// 1 − 6 digits as they are read best.
fn number(x: f64) -> String {
    match x.abs() {
        0.0 => "0".into(),
        a if (1e-3..1e5).contains(&a) => format!("{x:.5}"),
        _ => format!("{x:.3e}"),
    }
}

fn z(row: &Row) -> String {
    match row.z {
        z if row.found.refused.is_some() || z.is_nan() => "–".into(),
        z if z.is_infinite() => if z < 0.0 { "−∞" } else { "∞" }.into(),
        z => format!("{z:+.1}"),
    }
}

fn worst_channel(row: &Row) -> usize {
    let z = |c: usize| {
        let t = row.case.truth.value[c];
        row.found.single.mean[c]
            .z(t, row.case.truth.uncertainty * t.abs())
            .abs()
    };
    (0..row.case.truth.value.len())
        .max_by(|&a, &b| z(a).total_cmp(&z(b)))
        .unwrap_or(0)
}

fn index(row: &Row) -> String {
    match row.found.single.tail.index {
        0.0 => "–".into(),
        a if a > 99.0 => ">99".into(),
        a => format!("{a:.1}"),
    }
}

/// Energy that arrives over energy that should, with half of its interval.
fn energy(row: &Row) -> String {
    let known = row.found.energy(&row.case);
    known.map_or("–".into(), |e| {
        format!("{:.4} ± {:.4}", e.value, 0.5 * (e.high - e.low))
    })
}

fn diagnostics(row: &Row) -> String {
    let m = &row.found.single;
    let counted = [
        (m.rejected, "rejected"),
        (m.cut, "cut walks"),
        (m.full, "full walks"),
        (m.refused, "refused by the film"),
    ];
    let parts: Vec<_> = counted
        .iter()
        .filter(|(n, _)| *n > 0)
        .map(|(n, what)| format!("{n} {what}"))
        .collect();
    parts.join(", ")
}

/// One line: how the whole went.
pub fn summary(rows: &[Row]) -> String {
    let met = rows.iter().filter(|r| r.is_met()).count();
    let cases: std::collections::HashSet<_> = rows.iter().map(|r| &r.case.name).collect();
    format!(
        "{} cases, {} outcomes: {met} as written down, {} differ; right code fails at most {FALSE_ALARM:.0e} of all seeds",
        cases.len(),
        rows.len(),
        rows.len() - met
    )
}

/// The rows as text.
pub fn table(rows: &[Row]) -> String {
    let mut out = String::new();
    let _ = writeln!(
        out,
        "{:<27}{:<17}{:<22}{:<17}{:>10} {:>10} {:>17} {:>7} {:>6} {:>9} {:>9}  counted",
        "case",
        "estimator",
        "expected",
        "found",
        "truth",
        "mean",
        "mean/truth",
        "z",
        "α",
        "max/mean",
        "f32/f64−1"
    );
    for r in rows {
        let c = worst_channel(r);
        let m = &r.found.single;
        let _ = writeln!(
            out,
            "{:<27}{:<17}{:<22}{:<17}{:>10} {:>10} {:>17} {:>7} {:>6} {:>9.1e} {:>9.1e}  {}{}",
            r.case.name,
            r.name(),
            r.expected.what.to_string(),
            r.outcome.to_string(),
            number(r.case.truth.value[c]),
            number(m.mean[c].mean),
            energy(r),
            z(r),
            index(r),
            m.tail.largest,
            r.single_over_double,
            diagnostics(r),
            if r.is_met() { "" } else { "  ← differs" },
        );
    }
    for r in rows.iter().filter(|r| !r.is_met()) {
        for d in &r.differs {
            let _ = writeln!(out, "{}, {}: {d}", r.case.name, r.name());
        }
    }
    let _ = writeln!(out, "{}", summary(rows));
    out
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

const STYLE: &str = "
:root{color-scheme:light dark}
body{font:15px/1.45 system-ui,sans-serif;max-width:72rem;margin:2rem auto;padding:0 1rem}
h1{font-size:1.5rem}h2{font-size:1.1rem;margin:2rem 0 .2rem}
p{margin:.3rem 0}.small{font-size:.87rem;opacity:.8}
.wide{overflow-x:auto}
table{border-collapse:collapse;width:100%;font-size:.87rem;margin:.5rem 0}
th,td{text-align:right;padding:.25rem .5rem;border-bottom:1px solid #8884;vertical-align:top;white-space:nowrap}
th{font-weight:600}td.text,th.text{text-align:left}
tr.numbers td{border-bottom:0;padding-bottom:0}td.why{white-space:normal;text-align:left;padding-top:0;opacity:.85}
td.why div{position:sticky;left:.5rem;max-width:min(60rem,calc(100vw - 3rem))}
.right{color:#15803d}.misses,.heavy,.refused,.biased{color:#b45309}
.differs{background:#dc26262e}.differs td.outcome{color:#dc2626;font-weight:600}
.warning{border-left:3px solid #b45309;padding-left:.6rem}
@media (prefers-color-scheme:dark){.right{color:#4ade80}.misses,.heavy,.refused,.biased{color:#fbbf24}}
";

/// The rows as one page that needs nothing else.
pub fn html(ready: &[Ready], rows: &[Row]) -> String {
    let mut out = String::new();
    let _ = write!(
        out,
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"><title>Where methods fail</title><style>{STYLE}</style></head><body>\n<h1>Where methods fail</h1>\n<p>{}.</p>\n",
        escape(&summary(rows))
    );
    out.push_str("<p class=\"small\">mean/truth: energy that arrives over energy that should, all channels together, with its 95 % interval. z: standard errors of 32 batches between mean and truth; of a bias that double precision hasn't, or the scene without what is added to it, between the two. α: Hill's estimate of the tail index of the samples' contributions (of chains: of the samples that they start from); below 2 their variance is infinite. max/mean: the largest contribution over the mean. f32/f64−1: single against double precision, the same random numbers; where few samples carry the image, of contributions clipped at their mean. A biased or heavy outcome needs a warning that names the cure.</p>\n");
    for r in ready {
        let mine: Vec<_> = rows
            .iter()
            .filter(|row| row.case.name == r.case.name)
            .collect();
        let truth: Vec<_> = r.case.truth.value.iter().map(|&t| number(t)).collect();
        let _ = write!(
            out,
            "<h2 id=\"{0}\">{0}</h2>\n<p>{1}</p>\n<p class=\"small\">Truth: {2}. {3}</p>\n",
            escape(&r.case.name),
            escape(&r.case.about),
            truth.join(", "),
            escape(&r.case.truth.source)
        );
        for w in &r.warnings {
            let _ = writeln!(
                out,
                "<p class=\"small warning\">The program warns: {}</p>",
                escape(w)
            );
        }
        out.push_str("<div class=\"wide\"><table><tr><th class=\"text\">estimator</th><th class=\"text\">expected</th><th class=\"text\">found</th><th>mean</th><th>mean/truth</th><th>z</th><th>α</th><th>max/mean</th><th>f32/f64−1</th></tr>\n");
        for row in mine {
            html_row(&mut out, row);
        }
        out.push_str("</table></div>\n");
    }
    out.push_str("</body></html>\n");
    out
}

fn html_row(out: &mut String, row: &Row) {
    let class = match row.expected.what {
        Expectation::Right => "right",
        Expectation::Misses => "misses",
        Expectation::Heavy => "heavy",
        Expectation::Refused => "refused",
        Expectation::Biased { .. } => "biased",
    };
    let c = worst_channel(row);
    let m = &row.found.single;
    let mut notes = vec![row.expected.why.clone()];
    notes.extend(row.found.refused.map(|r| format!("Refused: {r}.")));
    let said = row.found.warnings.iter().chain(&row.found.loss);
    notes.extend(said.map(|w| format!("Warns: {w}.")));
    notes.extend(row.found.unreachable.iter().map(|s| format!("Named: {s}.")));
    let counted = diagnostics(row);
    if !counted.is_empty() {
        notes.push(format!("Counted: {counted}."));
    }
    notes.extend(row.differs.iter().map(|d| format!("Differs: {d}.")));
    let mean = if row.found.refused.is_some() {
        "–".into()
    } else {
        format!("{} ± {}", number(m.mean[c].mean), number(m.mean[c].error))
    };
    // Words stand below the numbers, where a narrow window shows them too.
    let differs = if row.is_met() { "" } else { "differs" };
    let _ = writeln!(
        out,
        "<tr class=\"numbers {differs}\"><td class=\"text\">{}</td><td class=\"text {class}\">{}</td><td class=\"text outcome\">{}</td><td>{mean}</td><td>{}</td><td>{}</td><td>{}</td><td>{:.1e}</td><td>{:.1e}</td></tr>\n<tr class=\"{differs}\"><td class=\"why\" colspan=\"9\"><div>{}</div></td></tr>",
        row.name(),
        row.expected.what,
        row.outcome,
        energy(row),
        z(row),
        index(row),
        m.tail.largest,
        row.single_over_double,
        escape(&notes.join(" ")),
    );
}
