//! What remains of small kernels.

use rspirv::binary::Assemble;
use rspirv::dr;
use rspirv::spirv::Op;

use crate::testing::{Body, Kernel};
use crate::{Error, Kernel as Cut, Kernels};

/// The kernel that `body` makes with the value of a specialisation constant in place.
pub(super) fn cut(value: u32, body: impl FnOnce(&mut Body, u32)) -> Cut {
    let mut kernel = Kernel::new();
    let special = kernel.spec_constant(1, 0);
    kernel.entry("kernel", |b| body(b, special));
    let bytes: Vec<u8> = kernel.module().assemble().into_iter().flat_map(u32::to_le_bytes).collect();
    Kernels::parse(&bytes).unwrap().cut("kernel", &[(1, value)]).unwrap()
}

/// Every instruction of such a kernel.
pub(super) fn folded(value: u32, body: impl FnOnce(&mut Body, u32)) -> Vec<Op> {
    let cut = cut(value, body);
    let module = dr::load_words(cut.words()).unwrap();
    assert!(!module.types_global_values.iter().any(|inst| inst.class.opcode == Op::SpecConstant));
    let blocks = module.functions.iter().flat_map(|function| &function.blocks);
    let ops: Vec<Op> = blocks.flat_map(|block| &block.instructions).map(|inst| inst.class.opcode).collect();
    assert_eq!(cut.instructions(), ops.len());
    ops.into_iter().filter(|op| !matches!(op, Op::Branch | Op::Return)).collect()
}

#[test]
fn what_a_constant_rules_out_is_gone_and_its_branch_too() {
    let body = |b: &mut Body, special| {
        let x = b.load_input();
        b.if_has(special, 4, |b| {
            let y = b.f_mul(x, x);
            b.store_output(y);
        });
        b.if_has(special, 8, |b| b.store_output(x));
    };
    assert_eq!(folded(0, body), []);
    assert_eq!(folded(4, body), [Op::Load, Op::FMul, Op::Store]);
    assert_eq!(folded(8, body), [Op::Load, Op::Store]);
    assert_eq!(folded(12, body), [Op::Load, Op::FMul, Op::Store, Op::Store]);
}

/// What is left of a way around nothing are no blocks of their own, so that it leaves no trace.
#[test]
fn blocks_that_only_follow_one_another_become_one() {
    let blocks =
        |value, body: fn(&mut Body, u32)| dr::load_words(cut(value, body).words()).unwrap().functions[0].blocks.len();
    let choices: fn(&mut Body, u32) = |b, special| {
        let x = b.load_input();
        b.if_has(special, 4, |b| b.if_has(special, 8, |b| b.store_output(x)));
        b.store_output(x);
    };
    assert_eq!([0, 4, 12].map(|value| blocks(value, choices)), [1, 1, 1]);
    // Where a selection ends that is still one, a block begins.
    let open: fn(&mut Body, u32) = |b, special| {
        let word = b.load_counter(rspirv::spirv::MemoryAccess::NONE);
        b.if_has(word, 1, |b| {
            let x = b.load_input();
            b.if_has(special, 1, |b| b.store_output(x));
        });
    };
    assert_eq!([0, 1].map(|value| blocks(value, open)), [3, 3]);
}

/// As it was put there first, or last.
#[test]
fn a_part_of_a_composite_is_what_was_put_there() {
    let stored = |place: u32, inserted: u32| {
        folded(0, |b, _| {
            let (x, one) = (b.load_input(), b.constant_f32(0x3f80_0000));
            let y = b.f_add(x, one);
            let z = b.f_mul(x, one);
            let pair = b.pair(x, y);
            let pair = b.pair_with(pair, inserted, z);
            let part = b.part(pair, place);
            b.store_output(part);
        })
    };
    assert_eq!(stored(0, 1), [Op::Load, Op::Store]);
    assert_eq!(stored(1, 0), [Op::Load, Op::FAdd, Op::Store]);
    assert_eq!((stored(0, 0), stored(1, 1)), (stored(1, 1), vec![Op::Load, Op::FMul, Op::Store]));
}

/// Whichever way led there, a part that all have in common is known, and one that differs is not.
#[test]
fn a_part_that_every_way_has_in_common_is_known_where_they_join() {
    let stored = |place: u32| {
        folded(0, |b, _| {
            let (x, one) = (b.load_input(), b.constant_f32(0x3f80_0000));
            let word = b.load_counter(rspirv::spirv::MemoryAccess::NONE);
            let sum = |b: &mut Body| {
                let y = b.f_add(x, one);
                b.pair(x, y)
            };
            let product = |b: &mut Body| {
                let y = b.f_mul(x, one);
                b.pair(x, y)
            };
            let pair = b.pair_if(word, 1, sum, product);
            let again = b.pair_if(word, 2, |_| pair, |b| b.pair_with(pair, 1, one));
            let part = b.part(again, place);
            b.store_output(part);
        })
    };
    let has = |ops: &[Op], op| ops.contains(&op);
    assert!(!has(&stored(0), Op::CompositeExtract) && !has(&stored(0), Op::FAdd), "{:?}", stored(0));
    assert!(has(&stored(1), Op::CompositeExtract) && has(&stored(1), Op::FAdd), "{:?}", stored(1));
}

/// Its places are not those of its parts.
#[test]
fn a_part_of_a_vector_of_vectors_is_taken_by_the_device() {
    let stored = |parts: fn(&mut Body, u32) -> u32| {
        folded(0, |b, _| {
            let x = b.load_input();
            let vector = parts(b, x);
            let part = b.part(vector, 1);
            b.store_output(part);
        })
    };
    assert_eq!(stored(|b, x| b.vector(3, &[x, x, x])), [Op::Load, Op::Store]);
    let nested = stored(|b, x| {
        let two = b.vector(2, &[x, x]);
        b.vector(3, &[two, x])
    });
    assert_eq!(nested, [Op::Load, Op::CompositeConstruct, Op::CompositeConstruct, Op::CompositeExtract, Op::Store]);
}

#[test]
fn a_value_that_is_not_constant_decides_nothing() {
    let ops = folded(0, |b, _| {
        let word = b.load_counter(rspirv::spirv::MemoryAccess::NONE);
        b.if_has(word, 1, |b| {
            let x = b.load_input();
            b.store_output(x);
        });
    });
    let kept =
        [Op::Load, Op::BitwiseAnd, Op::INotEqual, Op::SelectionMerge, Op::BranchConditional, Op::Load, Op::Store];
    assert_eq!(ops, kept);
}

#[test]
fn floats_are_left_to_the_device() {
    let ops = folded(0, |b, _| {
        let one = b.constant_f32(0x3f80_0000);
        let two = b.f_add(one, one);
        b.store_output(two);
    });
    assert_eq!(ops, [Op::FAdd, Op::Store]);
}

/// A loop that is never entered keeps no round, and one that is always left keeps a way back that is never taken.
#[test]
fn loops_stay_whole_whatever_is_known_of_them() {
    let body = |b: &mut Body, special| {
        let word = b.load_counter(rspirv::spirv::MemoryAccess::NONE);
        let count = b.count_up_to(word, special);
        b.store_counter(count);
    };
    let whole = [Op::Load, Op::Phi, Op::ULessThan, Op::LoopMerge, Op::BranchConditional, Op::IAdd, Op::Store];
    assert_eq!(folded(0, body), whole);
    let left: Vec<Op> = folded(1, body);
    assert_eq!(left.iter().filter(|op| **op == Op::LoopMerge).count(), 1, "{left:?}");
    assert!(!left.contains(&Op::IAdd), "{left:?}");
}

/// Its way back is one emptied block then, from which its counter has no value in particular.
#[test]
fn a_counter_keeps_a_value_for_every_way_into_its_loop() {
    let module = dr::load_words(cut(1, |b, special| b.leave_long_loop(special)).words()).unwrap();
    let function = &module.functions[0];
    assert_eq!(
        function.blocks.len(),
        4,
        "one of two blocks is left of the way back, and one of the two before the loop"
    );
    let phi = function.all_inst_iter().find(|inst| inst.class.opcode == Op::Phi).unwrap();
    assert_eq!(phi.operands.len(), 4, "two ways in");
}

#[test]
fn what_is_no_module_and_what_has_no_entry_is_refused() {
    assert!(matches!(Kernels::parse(&[1, 2, 3, 4]), Err(Error::Malformed(_))));
    let bytes: Vec<u8> = Kernel::new().module().assemble().into_iter().flat_map(u32::to_le_bytes).collect();
    let missing = Kernels::parse(&bytes).unwrap().cut("kernel", &[]);
    assert_eq!(missing.err(), Some(Error::NoEntry("kernel".to_owned())));
}
