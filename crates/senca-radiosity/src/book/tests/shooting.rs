//! Shooting against gathering, and against its textbook form.

use super::*;
use crate::system::Shooting;

fn by(relaxation: Relaxation) -> BookSettings {
    BookSettings { rounds: 1, relaxation, ..BookSettings::default() }
}

fn rule() -> ShootingRule {
    ShootingRule::default()
}

fn furnished_mesh() -> ElementMesh {
    let mut mesh = mesh_of(&furnished(0.6, 0.0, 5.0));
    mesh.divide_to_size(0.7, 1 << 20).expect("few");
    mesh
}

/// Largest difference of values as a share of the mean.
fn difference(a: &[f32], b: &[f32]) -> f32 {
    assert_eq!(a.len(), b.len());
    let mean = b.iter().sum::<f32>() / b.len() as f32;
    a.iter().zip(b).map(|(a, b)| (a - b).abs() / mean).fold(0.0, f32::max)
}

fn shown(solution: &Solution) -> Vec<f32> {
    (0..solution.mesh.polygons().len() as u32).map(|p| solution.radiosity(p).g).collect()
}

#[test]
fn what_is_shot_is_what_is_gathered() {
    let solved = |settings: &BookSettings| {
        solve_mesh(furnished_mesh(), &no_lamps(), settings, &Control::default(), |_| ()).expect("solved")
    };
    let gathered = solved(&by(Relaxation::GaussSeidel));
    let shot = solved(&by(Relaxation::Shooting(rule())));
    assert!(shot.solution.report.converged && shot.warnings.is_empty());
    assert!(shot.report.rounds == 1 && shot.solution.report.unsent <= 1e-4);
    let apart = difference(&shown(&shot.solution), &shown(&gathered.solution));
    assert!(apart < 0.01, "{apart}");
    // With less room for factors they are computed again, and the light is the same.
    let settings = BookSettings { rounds: 0, ..by(Relaxation::Shooting(rule())) };
    let tight = BookSettings { max_factors: 2000, ..settings };
    assert_eq!(solved(&tight).solution.incident, solved(&settings).solution.incident);
}

#[test]
fn early_pictures_have_light_everywhere_and_power_is_kept() {
    let settings = by(Relaxation::Shooting(rule()));
    let mut early: Vec<Solution> = Vec::new();
    let solved = solve_mesh(furnished_mesh(), &no_lamps(), &settings, &Control::default(), |solution| {
        early.push(solution.clone());
    })
    .expect("solved");
    assert!(early.len() > 5 && early[0].report.iterations == 1);
    for pair in early.windows(2) {
        assert!(pair[1].report.unsent <= pair[0].report.unsent + 1e-9);
    }
    for solution in &early {
        assert!(solution.report.energy_error < 1e-6, "{:?}", solution.report);
    }
    let last = shown(&solved.solution);
    let [first, without] = [true, false].map(|ambient| {
        let rule = ShootingRule { max_steps: 1, ambient, ..rule() };
        let solved = solve_mesh(
            furnished_mesh(),
            &no_lamps(),
            &by(Relaxation::Shooting(rule)),
            &Control::default(),
            |_| (),
        );
        shown(&solved.expect("solved").solution)
    });
    let missing = |values: &[f32]| {
        let apart = values.iter().zip(&last).map(|(a, b)| (a - b).abs());
        apart.sum::<f32>() / last.iter().sum::<f32>()
    };
    assert!(missing(&first) < 0.5 * missing(&without), "{} {}", missing(&first), missing(&without));
}

#[test]
fn steps_are_those_of_the_textbook() {
    let mut faces = cube_with(0.5, [1.0, 0.0, 0.0, 0.0, 0.0, 0.25]);
    faces[2].1 = grey(0.8);
    // Shooting by the matrix that the method of the book sets up.
    let (dark, settings) = (no_lamps(), BookSettings { rounds: 0, ..BookSettings::default() });
    let mut book = Book::new(mesh_of(&faces), &dark, &settings).expect("a book");
    book.illuminate(&Control::default()).expect("no lamps");
    book.rounds(&Control::default(), &mut |_: &Solution| ()).expect("solved");
    let system = book.system(book.factors.matrix.clone()).expect("a system");
    let mut textbook = Shooting::new(&system);
    for steps in 1..12 {
        textbook.shoot();
        let rule = ShootingRule { max_steps: steps, ..rule() };
        let solved = solve_faces(&faces, 1.5, &by(Relaxation::Shooting(rule)));
        for (found, expected) in radiosities(&solved).iter().zip(textbook.with_ambient()) {
            assert!((f64::from(*found) - expected[0]).abs() < 1e-4, "{steps}: {found}, not {expected:?}");
        }
        let unsent = solved.solution.report.unsent;
        assert!((unsent - textbook.unsent_share()).abs() < 1e-4, "{steps}: {unsent}");
    }
}

#[test]
fn interrupting_keeps_what_was_shot() {
    let stop = AtomicBool::new(false);
    let control = Control { cancel: Some(&stop), ..Control::default() };
    let mut seen = None;
    let settings = by(Relaxation::Shooting(rule()));
    let solved = solve_mesh(furnished_mesh(), &no_lamps(), &settings, &control, |solution| {
        if solution.report.iterations == 4 {
            seen = Some(solution.clone());
            stop.store(true, Ordering::Relaxed);
        }
    })
    .expect("four steps");
    assert_eq!(Some(&solved.solution.incident), seen.as_ref().map(|solution| &solution.incident));
    assert!(!solved.solution.report.converged && solved.warnings.len() == 1);
    assert_eq!(solved.solution.report.iterations, 4);
}

#[test]
fn lamps_and_steps_that_run_out() {
    let scene = lamp_over_table();
    let settings = by(Relaxation::Shooting(rule()));
    let shot = solve(&scene, &settings, &Control::default(), |_| ()).expect("solved");
    let gathered = solve(&scene, &by(Relaxation::GaussSeidel), &Control::default(), |_| ()).expect("solved");
    let apart = difference(&shown(&shot.solution), &shown(&gathered.solution));
    assert!(apart < 1e-3 && shot.solution.report.converged, "{apart}");
    let none = ShootingRule { max_steps: 0, ..rule() };
    let dark = solve_faces(&cube_with(0.5, [1.0; 6]), 1.5, &by(Relaxation::Shooting(none)));
    assert!(!dark.solution.report.converged && dark.solution.report.unsent == 1.0);
    // All that is unsent is everywhere alike here, so that the estimate is the solution.
    assert!(radiosities(&dark).iter().all(|b| (b - 2.0).abs() < 1e-5));
}
