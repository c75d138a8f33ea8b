//! scratch
fn main() {
    let path = std::env::args().nth(1).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let mut best = f64::MAX;
    for _ in 0..60 {
        let t = std::time::Instant::now();
        let s = senca_io::obj::read("x.obj", &bytes, &senca_io::NoFiles).unwrap();
        best = best.min(t.elapsed().as_secs_f64());
        std::hint::black_box(&s);
    }
    #[expect(clippy::print_stdout)]
    {
        println!("{:.3} ms", best * 1e3);
    }
}
