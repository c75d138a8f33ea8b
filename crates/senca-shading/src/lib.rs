//! Reflection models, lights and fog.
