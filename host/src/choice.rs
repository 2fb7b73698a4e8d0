//! Choices by name: what files, options and tables call the values of an enum.

use crate::error::Error;

/// A value of a few, each with a name.
pub trait Named: Copy + 'static {
    /// Every value, in the order in which they are told.
    const VARIANTS: &'static [Self];

    /// What it is called: lower case, words joined by hyphens.
    fn name(self) -> &'static str;

    /// What it means, in a line without a full stop.
    fn help(self) -> &'static str;

    /// The value of this name.
    ///
    /// # Errors
    /// There is none; the error lists those that there are.
    fn from_name(name: &str) -> Result<Self, Error> {
        Self::VARIANTS.iter().copied().find(|value| value.name() == name).ok_or_else(|| Error::UnknownName {
            name: name.to_owned(),
            names: Self::VARIANTS.iter().map(|value| value.name()).collect(),
        })
    }
}

/// Makes an enum whose values have a line of help, which is their documentation too, and a name.
macro_rules! choices {
    (
        $(#[$of_all:meta])*
        $public:vis enum $choice:ident {
            $(
                #[doc = $help:literal]
                $(#[$of_one:meta])*
                $value:ident = $name:literal,
            )*
        }
    ) => {
        $(#[$of_all])*
        $public enum $choice {
            $(
                #[doc = $help]
                $(#[$of_one])*
                $value,
            )*
        }

        impl $crate::choice::Named for $choice {
            const VARIANTS: &'static [Self] = &[$($choice::$value),*];

            fn name(self) -> &'static str {
                match self {
                    $($choice::$value => $name,)*
                }
            }

            fn help(self) -> &'static str {
                let line = match self {
                    $($choice::$value => $help,)*
                };
                line.trim().trim_end_matches('.')
            }
        }

        impl ::std::fmt::Display for $choice {
            fn fmt(&self, out: &mut ::std::fmt::Formatter<'_>) -> ::std::fmt::Result {
                out.write_str($crate::choice::Named::name(*self))
            }
        }

        impl ::serde::Serialize for $choice {
            fn serialize<S: ::serde::Serializer>(&self, serializer: S) -> ::std::result::Result<S::Ok, S::Error> {
                serializer.serialize_str($crate::choice::Named::name(*self))
            }
        }

        impl<'de> ::serde::Deserialize<'de> for $choice {
            fn deserialize<D: ::serde::Deserializer<'de>>(from: D) -> ::std::result::Result<Self, D::Error> {
                let name = <::std::string::String as ::serde::Deserialize>::deserialize(from)?;
                $crate::choice::Named::from_name(&name).map_err(::serde::de::Error::custom)
            }
        }

        impl ::std::str::FromStr for $choice {
            type Err = $crate::error::Error;

            fn from_str(name: &str) -> $crate::error::Result<Self> {
                $crate::choice::Named::from_name(name)
            }
        }
    };
}

pub(crate) use choices;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::Method;
    use crate::render::Precision;

    #[test]
    fn names_are_read_as_they_are_written() {
        for &method in Method::VARIANTS {
            assert_eq!(method.to_string().parse(), Ok(method));
        }
        assert_eq!((Method::SequentialStack.name(), Method::default()), ("sequential-stack", Method::Auto));
        assert_eq!(Precision::Exact.help(), "The same picture bit for bit on every device");
        let unknown = "exactly".parse::<Precision>().unwrap_err();
        assert_eq!(unknown.to_string(), "\"exactly\" is none of exact, fast, reference");
    }
}
