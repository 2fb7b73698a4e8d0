//! `--device`, where it may name several.

use eyerays::choice::Named;
use eyerays::render::{DeviceName, DeviceWish, Several};

/// Where to render.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Devices {
    /// One of a kind.
    One(DeviceWish),
    /// Several together.
    Several(Several),
}

impl Devices {
    /// `auto`, `gpu`, `cpu`, `all`, or names with commas between: `gpu:0,gpu:1,cpu`.
    pub fn parse(text: &str) -> Result<Self, String> {
        if let Ok(one) = DeviceWish::from_name(text) {
            return Ok(Devices::One(one));
        }
        if text == "all" {
            return Ok(Devices::Several(Several::All));
        }
        let name = |word: &str| match word.trim().split_once(':') {
            None if word.trim() == "cpu" => Some(DeviceName::Cpu),
            None if word.trim() == "gpu" => Some(DeviceName::Gpu(None)),
            Some(("gpu", adapter)) if !adapter.is_empty() => Some(DeviceName::Gpu(Some(adapter.to_owned()))),
            _ => None,
        };
        let names: Option<Vec<_>> = text.split(',').map(name).collect();
        let names =
            names.ok_or("write auto, gpu, cpu, all, or several with commas between, for example gpu:0,gpu:1,cpu")?;
        Ok(Devices::Several(Several::These(names)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn devices_are_one_or_several_by_name() {
        assert_eq!(Devices::parse("cpu"), Ok(Devices::One(DeviceWish::Cpu)));
        assert_eq!(Devices::parse("all"), Ok(Devices::Several(Several::All)));
        let [gpu, cpu] = [DeviceName::Gpu(Some("RTX 1".to_owned())), DeviceName::Cpu];
        assert_eq!(Devices::parse("gpu:RTX 1, cpu"), Ok(Devices::Several(Several::These(vec![gpu.clone(), cpu]))));
        assert_eq!(Devices::parse("gpu:RTX 1"), Ok(Devices::Several(Several::These(vec![gpu]))));
        for text in ["", "tpu", "gpu:", "cpu:1", "gpu,,cpu", "all,cpu"] {
            assert!(Devices::parse(text).is_err(), "{text}");
        }
    }
}
