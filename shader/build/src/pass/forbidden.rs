//! What an exact module must not hold: instructions whose result Vulkan leaves to the device.

use std::collections::HashSet;

use eyerays_passes::{body, reach};
use rspirv::dr::{Function, Instruction, Module, Operand};
use rspirv::spirv::{GlslStd450Op, Op, Word};

use super::{inlining, names::Names};
use crate::{Error, Result};

const DIVISION: &str = "may occur in `#[inline(never)]` functions only; call `div` or `sqrt` of `real`";
const INEXACT: &str = "a device may round its own way; use + - * and the functions of `real`";
const UNORDERED: &str = "depends on the order of lanes; sum in a fixed order";
const TEXTURE: &str = "a device may filter its own way; read a buffer";
const WIDTH: &str = "not every device has, or rounds alike; use f32";
const VALUE: &str = "a device may flush or replace; use an integer for bit patterns";

/// Fails on the first forbidden instruction, type or constant. Run it before
/// [`inlining::release`], on a module without dead code.
pub fn check(module: &Module) -> Result<()> {
    let names = Names::of(module);
    let rules = Rules { floats: float_types(module)?, glsl: body::glsl_set(module) };
    for function in &module.functions {
        let protected = inlining::is_protected(function);
        for inst in function.all_inst_iter() {
            if let Some((what, why)) = rules.broken(inst, protected) {
                let function = names.function(function);
                return Err(Error::Forbidden { function, what, why });
            }
        }
    }
    constants(module, &rules.floats, &names)
}

struct Rules {
    floats: HashSet<Word>,
    glsl: Option<Word>,
}

impl Rules {
    fn broken(&self, inst: &Instruction, protected: bool) -> Option<(String, &'static str)> {
        let op = inst.class.opcode;
        let why = match op {
            Op::FDiv if protected => return None,
            Op::FDiv => DIVISION,
            Op::ExtInst => return self.extended(inst, protected),
            Op::FRem | Op::FMod | Op::Dot | Op::OuterProduct | Op::QuantizeToF16 => INEXACT,
            Op::VectorTimesMatrix | Op::MatrixTimesScalar | Op::MatrixTimesVector | Op::MatrixTimesMatrix => INEXACT,
            Op::AtomicFAddEXT | Op::AtomicFMinEXT | Op::AtomicFMaxEXT => UNORDERED,
            _ if self.is_float(inst) && is_group(inst.class.opname) => UNORDERED,
            _ if inst.class.opname.contains("Image") => TEXTURE,
            _ => return None,
        };
        Some((inst.class.opname.into(), why))
    }

    fn is_float(&self, inst: &Instruction) -> bool {
        inst.result_type.is_some_and(|id| self.floats.contains(&id))
    }

    fn extended(&self, inst: &Instruction, protected: bool) -> Option<(String, &'static str)> {
        let number = match inst.operands[1] {
            Operand::LiteralExtInstInteger(number) => number,
            _ => u32::MAX,
        };
        let known = inst.operands[0].id_ref_any() == self.glsl;
        let op = known.then(|| GlslStd450Op::from_u32(number)).flatten();
        match op {
            Some(GlslStd450Op::Sqrt | GlslStd450Op::InverseSqrt) if protected => None,
            Some(op @ (GlslStd450Op::Sqrt | GlslStd450Op::InverseSqrt)) => Some((format!("{op:?}"), DIVISION)),
            Some(op) if is_exact(op) => None,
            Some(op) => Some((format!("{op:?}"), INEXACT)),
            None => Some((format!("extended instruction {number}"), INEXACT)),
        }
    }
}

/// Does the specification fix every bit of the result? Not of a sign of floats, which may treat zeros and
/// NaN either way. A minimum or maximum may return either of two zeros too, and a fused product may be
/// rounded twice: `Real::lesser`, `greater` and `fused`, where the kernels' own come from, are for tests
/// that leave room for both.
fn is_exact(op: GlslStd450Op) -> bool {
    matches!(
        op,
        GlslStd450Op::FAbs
            | GlslStd450Op::FMin
            | GlslStd450Op::FMax
            | GlslStd450Op::Fma
            | GlslStd450Op::Floor
            | GlslStd450Op::Ceil
            | GlslStd450Op::Trunc
            | GlslStd450Op::RoundEven
            | GlslStd450Op::SAbs
            | GlslStd450Op::SSign
            | GlslStd450Op::UMin
            | GlslStd450Op::SMin
            | GlslStd450Op::UMax
            | GlslStd450Op::SMax
            | GlslStd450Op::UClamp
            | GlslStd450Op::SClamp
            | GlslStd450Op::FindILsb
            | GlslStd450Op::FindSMsb
            | GlslStd450Op::FindUMsb
    )
}

/// Does an instruction combine the values of several lanes? One that only moves them is fine.
fn is_group(name: &str) -> bool {
    let combines = ["FAdd", "FMul", "FMin", "FMax"];
    name.starts_with("Group") && combines.iter().any(|part| name.contains(part))
}

/// The float types and the vectors of floats; fails on any width but 32 bits.
fn float_types(module: &Module) -> Result<HashSet<Word>> {
    let mut floats = HashSet::new();
    for inst in &module.types_global_values {
        let is_float = match inst.class.opcode {
            Op::TypeFloat => true,
            Op::TypeVector => floats.contains(&inst.operands[0].unwrap_id_ref()),
            _ => false,
        };
        if inst.class.opcode == Op::TypeFloat && inst.operands[0] != Operand::LiteralBit32(32) {
            return Err(Error::Forbidden {
                function: "the module".into(),
                what: format!("f{}", inst.operands[0]),
                why: WIDTH,
            });
        }
        floats.extend(inst.result_id.filter(|_| is_float));
    }
    Ok(floats)
}

/// Fails on a subnormal or NaN constant.
fn constants(module: &Module, floats: &HashSet<Word>, names: &Names) -> Result<()> {
    let is_odd = |bits: u32| {
        let value = f32::from_bits(bits);
        value.is_nan() || value.is_subnormal()
    };
    for inst in &module.types_global_values {
        let is_float = inst.result_type.is_some_and(|id| floats.contains(&id));
        let Some(Operand::LiteralBit32(bits)) = inst.operands.first() else {
            continue;
        };
        if let (true, true, Some(id)) = (is_float, is_odd(*bits), inst.result_id) {
            let user = user(module, id).map(|function| names.function(function));
            return Err(Error::Forbidden {
                function: user.unwrap_or("the module".into()),
                what: format!("the float constant {bits:#010x}"),
                why: VALUE,
            });
        }
    }
    Ok(())
}

/// A function that uses constant `id`, alone or in a composite.
fn user(module: &Module, id: Word) -> Option<&Function> {
    let mut holders = HashSet::from([id]);
    for inst in &module.types_global_values {
        if reach::mentioned(inst).any(|id| holders.contains(&id)) {
            holders.extend(inst.result_id);
        }
    }
    module.functions.iter().find(|function| {
        let mut mentioned = function.all_inst_iter().flat_map(reach::mentioned);
        mentioned.any(|id| holders.contains(&id))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use eyerays_passes::testing::{Body, Kernel};

    /// What is forbidden in a kernel of this body.
    fn found(protected: bool, body: impl Fn(&mut Body)) -> Option<String> {
        let mut kernel = Kernel::new();
        if protected {
            let function = kernel.protected(body);
            kernel.entry("exact_a", |b| b.call(function));
        } else {
            kernel.entry("exact_a", body);
        }
        match check(&kernel.module()) {
            Ok(()) => None,
            Err(Error::Forbidden { what, .. }) => Some(what),
            Err(other) => panic!("{other}"),
        }
    }

    #[test]
    fn division_and_root_in_protected_functions_only() {
        let division = |b: &mut Body| {
            let x = b.load_input();
            b.f_div(x, x);
        };
        assert_eq!(found(false, division).as_deref(), Some("FDiv"));
        assert_eq!(found(true, division), None);
        for op in [GlslStd450Op::Sqrt, GlslStd450Op::InverseSqrt] {
            let root = |b: &mut Body| {
                let x = b.load_input();
                b.glsl(op, x);
            };
            assert_eq!(found(false, root), Some(format!("{op:?}")));
            assert_eq!(found(true, root), None);
        }
    }

    #[test]
    fn extended_instructions_by_list() {
        for (op, allowed) in [
            (GlslStd450Op::FAbs, true),
            (GlslStd450Op::Floor, true),
            (GlslStd450Op::Round, false),
            (GlslStd450Op::Sin, false),
            (GlslStd450Op::Normalize, false),
        ] {
            let result = found(true, |b| {
                let x = b.load_input();
                b.glsl(op, x);
            });
            assert_eq!(result.is_none(), allowed, "{op:?}");
        }
    }

    #[test]
    fn odd_constants() {
        for (bits, allowed) in [
            (1.0_f32.to_bits(), true),
            (0, true),
            (0x8000_0000, true),
            (f32::INFINITY.to_bits(), true),
            (1, false),
            (0x807f_ffff, false),
            (0x7fc0_0000, false),
        ] {
            let result = found(false, |b| {
                let x = b.constant_f32(bits);
                b.store_output(x);
            });
            assert_eq!(result.is_none(), allowed, "{bits:#x}");
        }
    }

    #[test]
    fn widths_sums_and_remainders() {
        let half = |b: &mut Body| b.float_type(16);
        let sum = |b: &mut Body| {
            let x = b.load_input();
            b.subgroup_sum(x);
        };
        let remainder = |b: &mut Body| {
            let x = b.load_input();
            b.f_rem(x, x);
        };
        assert_eq!(found(false, half).as_deref(), Some("f16"));
        assert_eq!(found(false, sum).as_deref(), Some("GroupNonUniformFAdd"));
        assert_eq!(found(true, remainder).as_deref(), Some("FRem"));
    }

    #[test]
    fn plain_arithmetic_passes() {
        let plain = |b: &mut Body| {
            let x = b.load_input();
            let y = b.f_mul(x, x);
            let z = b.f_add(y, x);
            b.store_output(z);
        };
        assert_eq!(found(false, plain), None);
    }
}
