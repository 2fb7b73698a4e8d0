//! Traversal methods by name.

/// Makes the enum of the shader's table of methods.
macro_rules! ways {
    ([] $(#[doc = $help:literal] $variant:ident $path:ident $name:literal:
        gpu($($gpu:tt)*), persistent($($persistent:tt)*), cpu($($cpu:tt)*);)*) => {
        /// How rays are followed.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Way {
            $(#[doc = $help] $variant,)*
        }
    };
}
eyerays_shader::for_each_method!(ways);
