#![no_main]

use libfuzzer_sys::fuzz_target;
use senca_math::Expression;
use senca_math::Interval;
use senca_math::glam::DVec3;

fuzz_target!(|text: &str| {
    let Ok(formula) = Expression::parse(text) else { return };
    let again = Expression::parse(&formula.to_string()).expect("what is printed can be read");
    for p in [DVec3::ZERO, DVec3::new(0.3, -1.7, 2.5), DVec3::splat(-40.0)] {
        let value = formula.value(p);
        assert!(value == again.value(p) || value.is_nan() && again.value(p).is_nan(), "{text:?} at {p}");
        let around = formula.interval(p.to_array().map(|c| Interval::new(c - 1e-3, c + 1e-3)));
        assert!(!value.is_finite() || around.contains(value), "{value} is not in {around:?}");
    }
    let _ = formula.as_polynomial();
    let _ = formula.along_ray(DVec3::ONE, DVec3::NEG_Y);
});
