//! A chart's report in a browser: it lies within windows wide and narrow, and what it shows is there.

use crate::tools::{have, run, target, text};
use etendue::{Estimator, Settings};
use etendue_host::chart::{Facts, Measured, Plan, Subject, equal, html, measure, reference};
use etendue_host::develop::{AS_IT_IS, read};
use etendue_host::scene::{Changes, prepare};
use etendue_tests::place::root;
use serde_json::Value;
use std::collections::BTreeSet;
use std::process::Command;
use std::rc::Rc;
use std::sync::atomic::AtomicBool;

/// The Cornell box by four variants, one of which leaves light out and one of which has a long name, on a budget of a second each.
fn report() -> (usize, String) {
    let changes = Changes {
        width: Some(32),
        ..Changes::default()
    };
    let file = root().join("host/scenes/cornell-box.xml");
    let prepared = Rc::new(prepare(&file, &[], changes).unwrap());
    let subject = |name: &str, estimator, double| Subject {
        name: name.into(),
        prepared: Rc::clone(&prepared),
        settings: Settings {
            estimator,
            ..Settings::default()
        },
        double,
    };
    let stop = AtomicBool::new(false);
    let plan = Plan {
        seconds: 1.0,
        seeds: 2,
        threads: 0,
    };
    let both = subject("bidirectional", Estimator::Bidirectional, false);
    let reference = reference(&both, 2.0, 0, &stop).unwrap().unwrap();
    let long = "bidirectional, mis balance, sampler independent, max-depth -1, precision double";
    let subjects = [
        both,
        subject("path", Estimator::Path, false),
        subject("distributed", Estimator::Distributed, false),
        subject(long, Estimator::Bidirectional, true),
    ];
    let mut all: Vec<Measured> = Vec::new();
    for subject in subjects {
        let measured = measure(subject, &reference, &plan, &stop, &mut |_, _| ());
        all.push(measured.unwrap().unwrap());
    }
    assert!(equal::images(&mut all, &reference, &plan, &stop).unwrap());
    let facts = Facts {
        scene: "cornell-box.xml".into(),
        command: "etendue chart host/scenes/cornell-box.xml --estimators bidirectional,path,distributed --sweep precision=single,double -o report.html".into(),
        warnings: vec!["<scene> & \"its\" warning".into()],
        tone: AS_IT_IS,
        seeds: plan.seeds,
    };
    (all.len(), html(&all, &reference, &facts).unwrap())
}

#[test]
fn a_report_lies_within_wide_and_narrow_windows() {
    if !have("node") || !have("chromium") {
        return;
    }
    let folder = target("report");
    let file = folder.join("report.html");
    let (variants, page) = report();
    std::fs::write(&file, page).unwrap();
    let widths = [1280u32, 480];
    let picture = |width: u32| folder.join(format!("{width}.png"));
    let mut command = Command::new("node");
    command
        .arg(root().join("tests/embed/layout.mjs"))
        .arg(format!("file://{}", file.display()));
    for width in widths {
        command.arg(width.to_string()).arg(picture(width));
    }
    let said = text(&run(&mut command));
    let layouts: Vec<Value> = said
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert_eq!(layouts.len(), widths.len(), "{said}");
    for (layout, width) in layouts.iter().zip(widths) {
        assert_eq!(layout["complaints"], serde_json::json!([]));
        assert_eq!(layout["window"], width);
        // Less the bar at its right, by which the page is scrolled.
        let room = layout["width"].as_f64().unwrap();
        let scrolls = layout["scrolls"].as_f64().unwrap();
        assert!(scrolls <= room, "{width}: {scrolls} wide");
        let boxes = layout["boxes"].as_array().unwrap();
        // Five plots; an image and an error map of each variant, and the reference.
        let count = |what: &str| boxes.iter().filter(|b| b["what"] == what).count();
        assert_eq!((count("svg"), count("img")), (5, 2 * variants + 1));
        for b in boxes {
            let of = |key: &str| b[key].as_f64().unwrap();
            assert!(of("loaded") > 0.0, "{width}: {b}");
            assert!(of("width") > 100.0 && of("height") > 70.0, "{width}: {b}");
            assert!(of("left") >= 0.0 && of("right") <= room, "{width}: {b}");
        }
        // The picture that it makes, not an empty page.
        let shown = read(&picture(width)).unwrap();
        let colors: BTreeSet<_> = shown.pixels.iter().map(|p| p.map(f32::to_bits)).collect();
        assert_eq!(shown.size[0], width);
        assert!(
            shown.size[1] > 800 && colors.len() > 200,
            "{:?}, {} colours",
            shown.size,
            colors.len()
        );
    }
}
