//! One file that shows everything: no network, no other file.

use super::equal;
use super::measure::{Measured, Reference};
use super::plot::{Plot, Series, svg};
use crate::develop::{AS_IT_IS, Format, Linear, Tone, encode};
use crate::statistics::{Interval, student_quantile};
use base64::Engine;
use std::fmt::Write;

/// What a report says beside what was measured.
#[derive(Clone, Debug)]
pub struct Facts {
    /// The scene.
    pub scene: String,
    /// How to make it again.
    pub command: String,
    /// Warnings of the scene's readers.
    pub warnings: Vec<String>,
    /// How radiance is shown.
    pub tone: Tone,
    /// Seeds of each budget.
    pub seeds: u64,
}

const ERRORS: [&str; 2] = ["MSE", "relMSE"];

/// The plots: of error number `which`, against CPU time and against samples, and tails. Names are files' without extension.
pub fn plots(all: &[Measured], seeds: u64) -> Vec<(&'static str, Plot)> {
    let shown = || (0..).zip(all).filter(|(_, m)| m.refused.is_none());
    let ladder = |which: usize, x: fn(&super::measure::Rung) -> f64| -> Vec<Series> {
        let t = student_quantile(seeds as f64 - 1.0);
        shown()
            .map(|(number, m)| {
                let rungs = m.rungs.iter().filter(|r| r.error(which).0 > 0.0);
                let points = rungs.clone().map(|r| {
                    let (error, spread) = r.error(which);
                    let half = t * spread;
                    [x(r), error, error * error / (error + half), error + half]
                });
                Series {
                    name: m.subject.name.clone(),
                    number,
                    points: points.collect(),
                    hollow: rungs.map(|r| r.limited).collect(),
                }
            })
            .collect()
    };
    let plot = |which: usize, x: &str, series| Plot {
        title: format!("{} against {x}", ERRORS[which]),
        x: x.into(),
        y: ERRORS[which].into(),
        series,
        // Of a mean of n samples the variance falls as 1/n, its root as n^-1/2.
        slope: Some((-1.0, "1/N (RMSE: N^-1/2)".into())),
        marks: true,
    };
    let mut made = vec![
        (
            "mse-time",
            plot(0, "CPU seconds", ladder(0, |r| r.seconds())),
        ),
        (
            "mse-samples",
            plot(0, "samples per pixel", ladder(0, |r| r.passes as f64)),
        ),
        (
            "relmse-time",
            plot(1, "CPU seconds", ladder(1, |r| r.seconds())),
        ),
        (
            "relmse-samples",
            plot(1, "samples per pixel", ladder(1, |r| r.passes as f64)),
        ),
    ];
    let tails: Vec<Series> = shown()
        .filter_map(|(number, m)| {
            let tail = m.tail.as_ref()?;
            Some(Series {
                name: m.subject.name.clone(),
                number,
                points: tail.survival.iter().map(|&[p, x]| [x, p, p, p]).collect(),
                hollow: vec![false; tail.survival.len()],
            })
        })
        .collect();
    if !tails.is_empty() {
        made.push((
            "tail",
            Plot {
                title: "Contributions of single samples".into(),
                x: "contribution / mean of the image".into(),
                y: "share of samples above".into(),
                series: tails,
                slope: None,
                marks: false,
            },
        ));
    }
    made
}

/// Two digits and what they are uncertain by.
fn interval(i: Option<Interval>) -> String {
    match i {
        None => "–".into(),
        Some(i) if i.low == 0.0 || !i.high.is_finite() => number(i.value),
        Some(i) => format!(
            "{} ({} to {})",
            number(i.value),
            number(i.low),
            number(i.high)
        ),
    }
}

/// Three digits.
fn number(x: f64) -> String {
    if x == 0.0 || (1e-2..1e4).contains(&x.abs()) {
        let digits = (2 - x.abs().max(1e-9).log10().floor() as i32).clamp(0, 4) as usize;
        format!("{x:.digits$}")
    } else {
        format!("{x:.2e}")
    }
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

fn data(image: &Linear, tone: Tone) -> Result<String, String> {
    let png = encode(Format::Png, image, tone).map_err(|e| e.to_string())?;
    let text = base64::engine::general_purpose::STANDARD.encode(png);
    Ok(format!("data:image/png;base64,{text}"))
}

/// An error map: the root of the squared error, over `most`, from black over red and yellow to white.
fn heat(m: &Measured, size: [u32; 2], most: f32) -> Linear {
    let color = |squared: &f32| {
        let x = (squared.sqrt() / most).clamp(0.0, 1.0).sqrt();
        [3.0 * x, 3.0 * x - 1.0, 3.0 * x - 2.0].map(|c| c.clamp(0.0, 1.0))
    };
    Linear {
        size,
        pixels: m.error_map.iter().map(color).collect(),
    }
}

/// The largest root of a squared error but one pixel in a hundred, over all maps: the top of their common scale.
fn top(all: &[Measured]) -> f32 {
    let of = |m: &Measured| {
        let mut errors = m.error_map.clone();
        errors.sort_by(f32::total_cmp);
        errors
            .get(errors.len() * 99 / 100)
            .map_or(0.0, |e| e.sqrt())
    };
    all.iter()
        .map(of)
        .fold(0.0, f32::max)
        .max(f32::MIN_POSITIVE)
}

/// What variants leave out: those that lack the same paths share a line.
fn unreachable(out: &mut String, all: &[Measured], reference: &Reference) {
    let mut lines: Vec<(&str, Vec<String>)> = Vec::new();
    let variants = all
        .iter()
        .map(|m| (escape(&m.subject.name), &m.unreachable));
    let of_reference = std::iter::once(("the reference".to_owned(), &reference.unreachable));
    for (name, texts) in variants.chain(of_reference) {
        for text in texts {
            match lines.iter_mut().find(|(line, _)| line == text) {
                Some((_, names)) => names.push(name.clone()),
                None => lines.push((text, vec![name.clone()])),
            }
        }
    }
    for (text, names) in lines {
        let _ = write!(
            out,
            "<p class=\"warn unreachable\">Light paths that can't be made by {}: {}.</p>",
            names.join(", "),
            escape(text)
        );
    }
}

/// What each came to.
fn table(out: &mut String, all: &[Measured]) {
    let first = all.iter().find(|m| m.refused.is_none());
    out.push_str("<div class=\"wide\"><table><thead><tr><th>variant<th>samples per pixel<th>CPU s<th>MSE<th>relMSE<th>efficiency 1/(MSE·s)<th>to the first<th>efficiency 1/(relMSE·s)<th>to the first<th>tail index</tr></thead><tbody>");
    for m in all {
        let name = escape(&m.subject.name);
        if let Some(reason) = &m.refused {
            let _ = write!(
                out,
                "<tr><td>{name}<td colspan=\"9\">refused: {}</tr>",
                escape(reason)
            );
            continue;
        }
        let Some(last) = m.rungs.last() else { continue };
        let ratio = |which: usize| {
            let first = first.filter(|f| !std::ptr::eq(*f, m));
            first.and_then(|f| m.efficiency[which].over(&f.efficiency[which]))
        };
        let index = m.tail.as_ref().and_then(|t| t.index);
        let index = index.map_or("–".into(), |(i, e)| {
            if i > 10.0 {
                return "above 10".into();
            }
            let what = if i + 2.0 * e < 2.0 {
                " (infinite variance?)"
            } else {
                ""
            };
            format!("{i:.2} ± {e:.2}{what}")
        });
        let (mse, rel) = (last.error(0).0, last.error(1).0);
        let _ = write!(
            out,
            "<tr><td>{name}<td>{}<td>{}<td>{}<td>{}<td>{}<td>{}<td>{}<td>{}<td>{index}</tr>",
            last.passes,
            number(last.seconds()),
            number(mse),
            number(rel),
            interval(m.efficiency(0)),
            interval(ratio(0)),
            interval(m.efficiency(1)),
            interval(ratio(1)),
        );
    }
    out.push_str("</tbody></table></div>");
}

const STYLE: &str = "
:root{color-scheme:light dark;--ink:#1b1b1b;--paper:#fcfcfa;--line:#d5d5d0;--soft:#666}
@media(prefers-color-scheme:dark){:root{--ink:#e8e8e4;--paper:#17181a;--line:#3a3b3e;--soft:#a5a5a0}}
*{box-sizing:border-box}body{margin:0 auto;max-width:1500px;padding:1.2rem;background:var(--paper);color:var(--ink);font:16px/1.5 system-ui,sans-serif}
h1{font-size:1.5rem;margin:.2rem 0}h2{font-size:1.15rem;margin:2rem 0 .5rem;border-top:1px solid var(--line);padding-top:1rem}
code{font:13px/1.5 ui-monospace,monospace;overflow-wrap:anywhere}p{max-width:75ch;margin:.4rem 0}
.grid{display:grid;gap:1rem;grid-template-columns:repeat(auto-fit,minmax(min(100%,420px),1fr))}.small{grid-template-columns:repeat(auto-fill,minmax(min(100%,180px),1fr))}
figure{margin:0}figcaption{font-size:.85rem;color:var(--soft)}figure svg,figure img{width:100%;height:auto;display:block;background:#fff;border:1px solid var(--line)}
.small img{image-rendering:pixelated;background:#000}.wide{overflow-x:auto}table{border-collapse:collapse;font-size:.85rem;font-variant-numeric:tabular-nums}
th,td{text-align:left;padding:.3rem .7rem;border-bottom:1px solid var(--line);vertical-align:top}th{vertical-align:bottom}td{white-space:nowrap}td[colspan],td:first-child{white-space:normal}td:first-child{min-width:7rem;max-width:16rem}.note{color:var(--soft)}.warn{border-left:4px solid #d55e00;padding-left:.8rem}";

/// The report.
///
/// # Errors
/// If a plot or an image can't be encoded.
pub fn html(all: &[Measured], reference: &Reference, facts: &Facts) -> Result<String, String> {
    let mut out = String::new();
    let scene = escape(&facts.scene);
    let _ = write!(
        out,
        "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"><title>{scene}: speed against accuracy</title><style>{STYLE}</style><h1>{scene}: speed against accuracy</h1><p class=\"note\">Étendue {}, {} threads available. Made again by <code>{}</code></p>",
        env!("CARGO_PKG_VERSION"),
        std::thread::available_parallelism().map_or(1, usize::from),
        escape(&facts.command),
    );
    let noise = match reference.noise {
        Some([mse, _]) => format!(
            "Its own mean squared error is about {}; it is subtracted from all errors.",
            number(mse)
        ),
        None => "Its own noise is not known: where lines level off, it may be the reference that they show.".into(),
    };
    let _ = write!(
        out,
        "<p>Reference: {} {noise}</p>",
        escape(&reference.origin)
    );
    let limited: Vec<_> = all
        .iter()
        .filter(|m| m.rungs.iter().any(|r| r.limited))
        .collect();
    if !limited.is_empty() {
        let names: Vec<_> = limited.iter().map(|m| escape(&m.subject.name)).collect();
        let _ = write!(
            out,
            "<p class=\"warn\">The reference is the limit: hollow points of {} have an error of less than four times the reference's own. They don't count for efficiencies. A larger --reference-budget tells more.</p>",
            names.join(", ")
        );
    }
    unreachable(&mut out, all, reference);
    for warning in &facts.warnings {
        let _ = write!(out, "<p class=\"warn\">{}</p>", escape(warning));
    }
    out.push_str("<h2>Efficiency</h2>");
    table(&mut out, all);
    let _ = write!(
        out,
        "<p class=\"note\">The last budget of each, {} seeds; CPU seconds of all threads. Efficiencies are one over the mean of error × time over the trials of the three largest budgets that the reference can tell, with 95 % intervals (Student's t by the delta method; ratios: Welch). The tail index is Hill's, of the largest thousandth of contributions: below 2 the variance is infinite, far above it there is no tail.</p><h2>Error</h2><div class=\"grid\">",
        facts.seeds
    );
    for (name, plot) in plots(all, facts.seeds) {
        let _ = write!(
            out,
            "<figure id=\"{name}\">{}<figcaption>{}</figcaption></figure>",
            svg(&plot)?,
            match name {
                "tail" =>
                    "How often a sample contributes more than x times the image's mean: a line that falls slowly is noise in spikes. Chains have no independent samples and are left out.",
                _ =>
                    "Mean over seeds; bands are 95 % intervals of that mean. The dashed line is what independent samples give.",
            }
        );
    }
    out.push_str("</div><h2>Images</h2>");
    images(&mut out, all, reference, facts)?;
    out.push_str("</html>\n");
    Ok(out)
}

fn images(
    out: &mut String,
    all: &[Measured],
    reference: &Reference,
    facts: &Facts,
) -> Result<(), String> {
    let figure = |out: &mut String, image: &Linear, tone, caption: &str| -> Result<(), String> {
        let (source, caption) = (data(image, tone)?, escape(caption));
        let _ = write!(
            out,
            "<figure><img alt=\"{caption}\" src=\"{source}\"><figcaption>{caption}</figcaption></figure>"
        );
        Ok(())
    };
    let took: Vec<f64> = all
        .iter()
        .filter_map(|m| Some(m.shown.as_ref()?.trial.seconds))
        .collect();
    let least = took.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = took.iter().copied().fold(0.0, f64::max);
    let _ = write!(
        out,
        "<p class=\"note\">At equal time: each has as many samples as take {} CPU seconds by the times of its budgets, whole ones, one at least. They took {} to {}. One exposure.</p><div class=\"grid small\">",
        number(equal::time(all).unwrap_or(0.0)),
        number(least),
        number(greatest),
    );
    figure(out, &reference.image, facts.tone, "reference")?;
    for m in all {
        if let Some(shown) = &m.shown {
            let caption = format!(
                "{}: {} samples per pixel in {} CPU s, MSE {}",
                m.subject.name,
                shown.passes,
                number(shown.trial.seconds),
                number(shown.trial.errors[0])
            );
            figure(out, &shown.image, facts.tone, &caption)?;
        }
    }
    let most = top(all);
    let _ = write!(
        out,
        "</div><h2>Where the errors are</h2><p class=\"note\">Root mean squared error of a pixel over seeds, at the largest budget: black is 0, white is {} and more, the same in all (red to yellow is a quarter of that).</p><div class=\"grid small\">",
        number(most.into())
    );
    for m in all.iter().filter(|m| m.refused.is_none()) {
        figure(
            out,
            &heat(m, reference.image.size, most),
            AS_IT_IS,
            &m.subject.name,
        )?;
    }
    out.push_str("</div>");
    Ok(())
}

/// All numbers. `version` is that of this form.
pub fn json(all: &[Measured], reference: &Reference, facts: &Facts) -> serde_json::Value {
    let interval = |i: Option<Interval>| i.map(|i| serde_json::json!([i.value, i.low, i.high]));
    let variants: Vec<_> = all
        .iter()
        .map(|m| {
            serde_json::json!({
                "name": m.subject.name,
                "refused": m.refused,
                "unreachable": m.unreachable,
                "rungs": m.rungs.iter().map(|r| serde_json::json!({
                    "passes": r.passes,
                    "reference_is_the_limit": r.limited,
                    "trials": r.trials.iter().map(|t| serde_json::json!({
                        "cpu_seconds": t.seconds,
                        "mse": t.errors[0],
                        "rel_mse": t.errors[1],
                    })).collect::<Vec<_>>(),
                })).collect::<Vec<_>>(),
                "efficiency_mse": interval(m.efficiency(0)),
                "efficiency_rel_mse": interval(m.efficiency(1)),
                "ratio_mse": all.first().and_then(|f| interval(m.efficiency[0].over(&f.efficiency[0]))),
                "ratio_rel_mse": all.first().and_then(|f| interval(m.efficiency[1].over(&f.efficiency[1]))),
                "image": m.shown.as_ref().map(|s| serde_json::json!({
                    "passes": s.passes,
                    "cpu_seconds": s.trial.seconds,
                    "mse": s.trial.errors[0],
                    "rel_mse": s.trial.errors[1],
                })),
                "tail": m.tail.as_ref().map(|t| serde_json::json!({
                    "samples": t.samples,
                    "index": t.index.map(|(i, e)| [i, e]),
                    "survival": t.survival,
                })),
            })
        })
        .collect();
    serde_json::json!({
        "version": 1,
        "scene": facts.scene,
        "command": facts.command,
        "seeds": facts.seeds,
        "reference": {
            "origin": reference.origin,
            "mse": reference.noise.map(|n| n[0]),
            "rel_mse": reference.noise.map(|n| n[1]),
            "unreachable": reference.unreachable,
        },
        "image_cpu_seconds": equal::time(all),
        "variants": variants,
    })
}
