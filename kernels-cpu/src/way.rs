//! Traversal methods by name.

/// Makes the enum of the shader's table of methods.
macro_rules! ways {
    ([] $(#[doc = $help:literal] $variant:ident $path:ident $name:literal:
        gpu($($gpu:tt)*), persistent($($persistent:tt)*), cpu($how:ident $($cpu:tt)*);)*) => {
        /// How rays are followed.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Way {
            $(#[doc = $help] $variant,)*
        }

        impl Way {
            /// One that finds the same hits, each ray by itself.
            pub fn alone(self) -> Way {
                let how = match self {
                    $(Way::$variant => stringify!($how),)*
                };
                if matches!(how, "together" | "plainly") { Way::IfIf } else { self }
            }
        }
    };
}
eyerays_shader::for_each_method!(ways);
