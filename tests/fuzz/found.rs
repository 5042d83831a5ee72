//! What fuzzing found and a description says more clearly than an input.

use etendue_host::compile::{CompileError, compile};
use etendue_host::description::EmitterKind;
use etendue_tests::scenes::Builder;

fn refusal(build: impl FnOnce(&mut Builder)) -> CompileError {
    let mut b = Builder::new();
    build(&mut b);
    compile(&b.description).unwrap_err()
}

/// The density of a point on it overflowed, and the kernel refused the compiler's own blob.
#[test]
fn a_light_too_small_for_single_precision_is_refused() {
    let e = refusal(|b| {
        b.sphere([0.0; 3], f32::MIN_POSITIVE, None).emission = Some([1.0; 3]);
    });
    assert!(e.reason.starts_with("a light needs an area"), "{e}");
    let mut b = Builder::new();
    b.sphere([0.0; 3], 1e-18, None).emission = Some([1.0; 3]);
    assert!(compile(&b.description).is_ok());
}

/// Numbers that no loader checks: what the kernel refuses is refused by the compiler, in the object's name.
#[test]
fn a_number_out_of_range_is_refused_in_the_name_of_its_object() {
    let e = refusal(|b| {
        b.sphere([0.0; 3], 1.0, None).emission = Some([1.0; 3]);
        b.light(EmitterKind::Point {
            position: [0.0; 3],
            intensity: [f32::NAN; 3],
        });
    });
    assert_eq!(e.name, "light", "{e}");
    let e = refusal(|b| {
        b.sphere([0.0; 3], 1.0, None).emission = Some([1.0, 1e31, 1.0]);
    });
    assert_eq!(e.name, "shape 0", "{e}");
    let e = refusal(|b| {
        b.glass(f32::INFINITY);
    });
    assert_eq!(e.name, "material 0", "{e}");
    let e = refusal(|b| b.description.sensor.clip = [1.0, 0.5]);
    assert_eq!(e.name, "sensor", "{e}");
}
