//! The value of one instruction.

use rspirv::dr::Instruction;
use rspirv::spirv::{Op, Word};

/// What is known of an instruction's result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Known {
    /// This value.
    Value(u32),
    /// The same as that of another id.
    Same(Word),
}

/// What follows for an instruction's result from the values of its operands, as `value` tells them, of those that are
/// constant.
pub fn evaluate(inst: &Instruction, value: impl Fn(Word) -> Option<u32>) -> Option<Known> {
    let id = |i: usize| inst.operands.get(i).and_then(|operand| operand.id_ref_any());
    let at = |i: usize| id(i).and_then(&value);
    let op = inst.class.opcode;
    match op {
        Op::Phi => return phi(inst),
        Op::Select => return Some(Known::Same(if at(0)? != 0 { id(1)? } else { id(2)? })),
        Op::Not => return Some(Known::Value(!at(0)?)),
        Op::LogicalNot => return Some(Known::Value(u32::from(at(0)? == 0))),
        Op::BitCount => return Some(Known::Value(at(0)?.count_ones())),
        _ => {}
    }
    match (at(0), at(1)) {
        (Some(a), Some(b)) => both(op, a, b).map(Known::Value),
        (Some(a), None) => one(op, a, id(1)?),
        (None, Some(b)) => one(op, b, id(0)?),
        (None, None) => None,
    }
}

/// Of two constants.
fn both(op: Op, a: u32, b: u32) -> Option<u32> {
    let (signed_a, signed_b) = (a as i32, b as i32);
    Some(match op {
        Op::BitwiseAnd | Op::LogicalAnd => a & b,
        Op::BitwiseOr | Op::LogicalOr => a | b,
        Op::BitwiseXor => a ^ b,
        Op::ShiftLeftLogical if b < 32 => a << b,
        Op::ShiftRightLogical if b < 32 => a >> b,
        Op::ShiftRightArithmetic if b < 32 => (signed_a >> b) as u32,
        Op::IAdd => a.wrapping_add(b),
        Op::ISub => a.wrapping_sub(b),
        Op::IMul => a.wrapping_mul(b),
        Op::UDiv => a.checked_div(b)?,
        Op::UMod => a.checked_rem(b)?,
        Op::IEqual | Op::LogicalEqual => u32::from(a == b),
        Op::INotEqual | Op::LogicalNotEqual => u32::from(a != b),
        Op::ULessThan => u32::from(a < b),
        Op::ULessThanEqual => u32::from(a <= b),
        Op::UGreaterThan => u32::from(a > b),
        Op::UGreaterThanEqual => u32::from(a >= b),
        Op::SLessThan => u32::from(signed_a < signed_b),
        Op::SLessThanEqual => u32::from(signed_a <= signed_b),
        Op::SGreaterThan => u32::from(signed_a > signed_b),
        Op::SGreaterThanEqual => u32::from(signed_a >= signed_b),
        _ => return None,
    })
}

/// Of a constant and something else, in any order.
fn one(op: Op, constant: u32, other: Word) -> Option<Known> {
    match (op, constant) {
        (Op::BitwiseAnd | Op::LogicalAnd | Op::IMul, 0) => Some(Known::Value(0)),
        (Op::LogicalOr, 1) => Some(Known::Value(1)),
        // Not of integers: the other operand may have a sign where the result has none.
        (Op::LogicalAnd, 1) | (Op::LogicalOr, 0) => Some(Known::Same(other)),
        _ => None,
    }
}

/// One value from everywhere, itself aside.
fn phi(inst: &Instruction) -> Option<Known> {
    let values = inst.operands.chunks(2).filter_map(|pair| pair[0].id_ref_any());
    let mut others = values.filter(|&value| Some(value) != inst.result_id);
    let first = others.next()?;
    others.all(|value| value == first).then_some(Known::Same(first))
}
