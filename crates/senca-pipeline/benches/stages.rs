//! Times of the stages of the pipeline.

fn main() {
    divan::main();
}
