//! Typed indices into the arenas of a scene.

macro_rules! ids {
    ($($(#[$doc:meta])* $name:ident;)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(pub u32);

        impl $name {
            /// The index as `usize`.
            #[must_use]
            pub const fn index(self) -> usize {
                self.0 as usize
            }
        }
    )*};
}

ids! {
    /// Index into `Scene::nodes`.
    NodeId;
    /// Index into `Scene::geometries`.
    GeometryId;
    /// Index into `Scene::materials`.
    MaterialId;
    /// Index into `Scene::textures`.
    TextureId;
    /// Index into `Scene::images`.
    ImageId;
    /// Index into `Scene::lights`.
    LightId;
    /// Index into `Scene::cameras`.
    CameraId;
    /// Index into `Scene::animations`.
    AnimationId;
    /// Index into `Scene::skins`.
    SkinId;
}
