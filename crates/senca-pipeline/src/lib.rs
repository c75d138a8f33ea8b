//! The standard rendering pipeline over a scene.
