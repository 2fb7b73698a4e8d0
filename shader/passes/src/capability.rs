//! Capabilities: only what a module uses, since a device is asked for each.

use rustc_hash::FxHashSet;

use rspirv::dr::{Module, Operand};
use rspirv::spirv::Capability;

const SUBGROUP: [Capability; 7] = [
    Capability::GroupNonUniformVote,
    Capability::GroupNonUniformBallot,
    Capability::GroupNonUniformArithmetic,
    Capability::GroupNonUniformShuffle,
    Capability::GroupNonUniformShuffleRelative,
    Capability::GroupNonUniformClustered,
    Capability::GroupNonUniformQuad,
];

/// Removes the capabilities of subgroup operations that no instruction and no built-in variable needs.
pub fn prune(module: &mut Module) {
    let mut needed = needed(module);
    if SUBGROUP.iter().any(|capability| needed.contains(capability)) {
        needed.insert(Capability::GroupNonUniform);
    }
    module.capabilities.retain(|inst| {
        let capability = inst.operands[0].unwrap_capability();
        let is_subgroup = capability == Capability::GroupNonUniform || SUBGROUP.contains(&capability);
        !is_subgroup || needed.contains(&capability)
    });
}

/// The operands of group operations name alternatives, which their instructions decide; only
/// built-in variables count beside these.
fn needed(module: &Module) -> FxHashSet<Capability> {
    let bodies = module.functions.iter().flat_map(|f| f.all_inst_iter());
    let mut needed = FxHashSet::default();
    for inst in bodies.chain(&module.annotations) {
        needed.extend(inst.class.capabilities);
        let builtins = inst.operands.iter().filter(|o| matches!(o, Operand::BuiltIn(_)));
        needed.extend(builtins.flat_map(|operand| operand.required_capabilities()));
    }
    needed
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Body, Kernel};

    /// The capabilities that remain of all, `Shader` aside.
    fn remaining(body: impl FnOnce(&mut Body)) -> Vec<Capability> {
        let mut kernel = Kernel::new();
        kernel.capability(Capability::GroupNonUniform);
        for capability in SUBGROUP {
            kernel.capability(capability);
        }
        kernel.entry("fast_a", body);
        let mut module = kernel.module();
        prune(&mut module);
        let declared = module.capabilities.iter();
        declared
            .map(|inst| inst.operands[0].unwrap_capability())
            .filter(|capability| *capability != Capability::Shader)
            .collect()
    }

    #[test]
    fn only_used_ones_stay() {
        assert_eq!(remaining(|_| {}), []);
        let ballot = remaining(|b| b.ballot_count());
        let expected = [Capability::GroupNonUniform, Capability::GroupNonUniformBallot];
        assert_eq!(ballot, expected);
    }
}
