use proptest::prelude::*;

use super::*;

fn parse(text: &str) -> Expression {
    Expression::parse(text).unwrap_or_else(|error| panic!("{text}: {error}"))
}

fn value(text: &str, p: [f64; 3]) -> f64 {
    parse(text).value(DVec3::from_array(p))
}

#[test]
fn operators_bind_as_on_paper() {
    let p = [2.0, 3.0, 5.0];
    assert_eq!(value("x + y * z", p), 17.0);
    assert_eq!(value("(x + y) * z", p), 25.0);
    assert_eq!(value("-x^2", p), -4.0);
    assert_eq!(value("2^y^x", p), 512.0);
    assert_eq!(value("x - y - z", p), -6.0);
    assert_eq!(value("12 / x / y", p), 2.0);
    assert_eq!(value("x^-2", p), 0.25);
    assert_eq!(value("x - -y", p), 5.0);
    assert_eq!(value("--+-x", p), -2.0);
    assert_eq!(value("2.5e1 + .5 + 1.", p), 26.5);
    assert_eq!(value("max(x, y, z) - min(z, y, x)", p), 3.0);
    assert_eq!(value("pow(x, 3) + abs(-y) + sqrt(4 + z)", p), 14.0);
    assert_eq!(value("atan2(0, -1) - pi + log(e)", p), 1.0);
}

#[test]
fn negative_bases_take_whole_exponents_only() {
    assert_eq!(value("x^3", [-2.0, 0.0, 0.0]), -8.0);
    assert!(value("x^0.5", [-2.0, 0.0, 0.0]).is_nan());
    assert_eq!(value("x^0.5", [4.0, 0.0, 0.0]), 2.0);
}

#[test]
fn mistakes_are_shown_where_they_are() {
    let error = |text: &str| Expression::parse(text).expect_err("a mistake").to_string();
    assert_eq!(error("x + "), "column 5: expected a number, x, y, z, a function or \"(\", but found the end");
    assert_eq!(error("2x"), "column 2: expected an operator or the end, but found \"x\"");
    assert_eq!(error("(x + 1"), "column 7: expected an operator or \")\", but found the end");
    assert_eq!(error("sin x"), "column 5: expected \"(\" after sin, but found \"x\"");
    assert_eq!(error("sin(x, y)"), "column 1: sin takes one argument, but has 2");
    assert_eq!(error("x + max(y)"), "column 5: max takes two arguments or more, but has 1");
    assert!(error("x + w^2").starts_with("column 5: unknown name \"w\". Known are x, y, z, pi"));
    assert_eq!(error("1e999 + x"), "column 1: the number 1e999 is too large");
    assert_eq!(error("é"), "column 1: expected a number, x, y, z, a function or \"(\", but found \"é\"");
    assert!(error("").contains("column 1"));
    assert!(error("x ! y").contains("column 3"));
}

#[test]
fn hostile_texts_end_in_an_error() {
    let deep = format!("{}x{}", "(".repeat(8000), ")".repeat(8000));
    assert!(matches!(Expression::parse(&deep), Err(ExpressionError::TooDeep { column: 66 })));
    assert!(matches!(Expression::parse(&"2^".repeat(5000)), Err(ExpressionError::TooDeep { .. })));
    assert!(matches!(Expression::parse(&"x+".repeat(20000)), Err(ExpressionError::TooLong { .. })));
    let long = format!("{}x", "-".repeat(10000));
    assert_eq!(parse(&long).value(DVec3::X), 1.0);
    let nested = format!("{}x{}", "1+(x*".repeat(60), ")".repeat(60));
    assert!(parse(&nested).value(DVec3::splat(0.5)).is_finite());
    assert!(parse("1/0 + x").value(DVec3::X).is_nan());
}

#[test]
fn constants_are_worked_out() {
    assert_eq!(parse("x^(1 + 1)").to_string(), "x^2");
    assert_eq!(parse("2 * 3 * x").to_string(), "6 * x");
    assert_eq!(parse("sqrt(9)").to_string(), "3");
    assert_eq!(parse("x - (y - z)").to_string(), "x - (y - z)");
    assert_eq!(parse("(x^2)^3").to_string(), "(x^2)^3");
    assert_eq!(parse("(-2)^2 * -x").to_string(), "4 * -x");
    assert_eq!(parse("x^-2").to_string(), "x^-2");
    assert_eq!(parse("1e300 * x + 1e-9").to_string(), "1e300 * x + 1e-9");
}

#[test]
fn degrees_tell_polynomials_from_others() {
    let degree = |text: &str| parse(text).degree();
    assert_eq!(degree("x^2 + y^2 + z^2 - 1"), Some(2));
    assert_eq!(degree("(x^2 + y*z)^3 / 4 - x^5"), Some(6));
    assert_eq!(degree("sqrt(5) * x + cos(1)"), Some(1));
    assert_eq!(degree("1 / x"), None);
    assert_eq!(degree("x^-1"), None);
    assert_eq!(degree("sin(x)"), None);
    assert_eq!(degree("x^33"), None);
    assert_eq!(degree("(x^30)^1000000"), None);
}

#[test]
fn a_cubic_of_the_course_along_the_x_axis() {
    let f = parse("x^3 - 6*x^2 + 11*x - 6 + y^2 + z^2");
    let along = f.along_ray(DVec3::ZERO, DVec3::X).expect("a polynomial");
    assert_eq!(along.coefficients(), [-6.0, 11.0, -6.0, 1.0]);
    assert_eq!(f.value_and_gradient(DVec3::X), (0.0, DVec3::new(2.0, 0.0, 0.0)));
    assert_eq!(f.value_along_ray(DVec3::ZERO, DVec3::X, 1.0), (0.0, 2.0));
    let (values, slopes) = f.interval_along_ray(DVec3::ZERO, DVec3::X, Interval::new(0.9, 1.1));
    assert!(values.contains_zero() && slopes.contains(2.0) && !slopes.contains_zero());
}

#[test]
fn multiplied_out() {
    let square = parse("(x + 2*y)^2 - x^2").as_polynomial().expect("a polynomial");
    let term = |powers, coefficient| Term { powers, coefficient };
    assert_eq!(square.terms(), [term([0, 2, 0], 4.0), term([1, 1, 0], 4.0)]);
    assert_eq!(square.degree(), 2);
    assert!(parse("sin(x)").as_polynomial().is_none());
    assert!(parse(&vec!["(x+y+z+1)^16*(x-y+2*z+3)^16"; 30].join("+")).as_polynomial().is_none());
}

/// Texts of formulas.
fn formulas(polynomial: bool) -> impl Strategy<Value = String> {
    let leaf = prop_oneof![
        Just("x".to_owned()),
        Just("y".to_owned()),
        Just("z".to_owned()),
        (-30i32..30).prop_map(|n| format!("{}", f64::from(n) / 10.0)),
    ];
    leaf.prop_recursive(4, 24, 3, move |inner| {
        let pair = (inner.clone(), inner.clone());
        let binary = (pair.clone(), prop::sample::select(vec!["+", "-", "*"]))
            .prop_map(|((a, b), op)| format!("({a}) {op} ({b})"));
        let power = (inner.clone(), 0..4).prop_map(|(a, n)| format!("({a})^{n}"));
        let negative = inner.clone().prop_map(|a| format!("-({a})"));
        if polynomial {
            return prop_oneof![binary, power, negative].boxed();
        }
        let names = vec![
            "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "sqrt", "abs",
        ];
        let call = (prop::sample::select(names), inner.clone()).prop_map(|(f, a)| format!("{f}({a})"));
        let two = (prop::sample::select(vec!["atan2", "pow", "min", "max"]), pair.clone())
            .prop_map(|(f, (a, b))| format!("{f}({a}, {b})"));
        let quotient = pair.prop_map(|(a, b)| format!("({a}) / ({b})"));
        let inverse = (inner, -3..0).prop_map(|(a, n)| format!("({a})^{n}"));
        prop_oneof![binary, power, negative, call, two, quotient, inverse].boxed()
    })
}

fn point() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-2.0f64..2.0).prop_map(DVec3::from_array)
}

proptest! {
    #[test]
    fn what_is_printed_reads_the_same(text in formulas(false)) {
        let f = parse(&text);
        let again = parse(&f.to_string());
        prop_assert_eq!(again.to_string(), f.to_string());
        prop_assert_eq!(again, f);
    }

    #[test]
    fn intervals_hold_all_values(text in formulas(false), low in point(), size in 0.0f64..2.0, share in prop::array::uniform3(0.0f64..1.0)) {
        let f = parse(&text);
        let share = DVec3::from_array(share);
        let bounds = Aabb { min: low, max: low + size };
        let p = (low + size * share).clamp(bounds.min, bounds.max);
        let value = f.value(p);
        let interval = f.interval_over(&bounds);
        prop_assert!(!value.is_finite() || interval.contains(value), "{f}: {value} is not in {interval:?}");
        let intervals = std::array::from_fn(|i| Interval::new(bounds.min[i], bounds.max[i]));
        prop_assert_eq!(f.interval_and_gradient(intervals).0, interval);
    }

    #[test]
    fn slopes_hold_differences(text in formulas(false), origin in point(), direction in point(), start in -1.0f64..1.0, length in 0.0f64..0.5) {
        let f = parse(&text);
        let t = Interval::new(start, start + length);
        let (values, slopes) = f.interval_along_ray(origin, direction, t);
        let at = |s: f64| f.value(origin + (start + s * length) * direction);
        let (a, b) = (at(0.25), at(0.75));
        if !(a.is_finite() && b.is_finite() && !slopes.is_empty() && length > 1e-3) {
            return Ok(());
        }
        let slack = 1e-9 * (1.0 + a.abs().max(b.abs()));
        prop_assert!(values.min - slack <= a && a <= values.max + slack, "{f}: {a} {values:?}");
        // By the mean value theorem, where f is defined all the way; else the slopes have no bounds.
        let mean = (b - a) / (0.5 * length);
        let slack = 1e-6 * (1.0 + slopes.magnitude());
        prop_assert!(slopes.min - slack <= mean && mean <= slopes.max + slack, "{f}: {mean} {slopes:?}");
    }

    #[test]
    fn gradients_are_limits_of_differences(text in formulas(true), p in point()) {
        let f = parse(&text);
        let (value, gradient) = f.value_and_gradient(p);
        prop_assert_eq!(value, f.value(p));
        let h = 1e-5;
        for i in 0..3 {
            let step = DVec3::AXES[i] * h;
            let difference = (f.value(p + step) - f.value(p - step)) / (2.0 * h);
            let size = f.interval_and_gradient(std::array::from_fn(|k| Interval::new(p[k] - 0.1, p[k] + 0.1)));
            let scale = 1.0 + size.0.magnitude() + size.1[i].magnitude();
            prop_assert!((difference - gradient[i]).abs() < 1e-4 * scale, "{f}: {difference} {gradient}");
        }
    }

    #[test]
    fn polynomials_have_the_formula_s_values(text in formulas(true), p in point(), direction in point(), t in -1.0f64..1.0) {
        let f = parse(&text);
        let Some(degree) = f.degree() else { return Ok(()) };
        let expected = f.value(p + t * direction);
        let along = f.along_ray(p, direction).expect("a polynomial");
        prop_assert!(along.degree() <= degree as usize);
        let magnitude: f64 = along.coefficients().iter().map(|c| c.abs()).sum();
        let scale = 1e-9 * (1.0 + magnitude + expected.abs());
        prop_assert!((along.value(t) - expected).abs() <= scale, "{f}: {} {expected}", along.value(t));
        if let Some(expanded) = f.as_polynomial() {
            let sizes: f64 = expanded.terms().iter().map(|t| t.coefficient.abs() * 4f64.powi(t.powers.iter().map(|&p| i32::from(p)).sum())).sum();
            let scale = 1e-12 * (1.0 + sizes);
            prop_assert!((expanded.value(p) - f.value(p)).abs() <= scale, "{f}");
            let other = expanded.along_ray(p, direction);
            prop_assert!((other.value(t) - expected).abs() <= scale + 1e-9 * (1.0 + magnitude), "{f}");
        }
    }
}
