//! A 3-D rendering system that needs no GPU: library and command.
