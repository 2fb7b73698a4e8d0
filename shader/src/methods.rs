//! The table of traversal methods: each once, with its kernels and its way on a CPU.

/// Gives every method to a macro, after what else is to be given to it. A row is
///
/// - what the method does, its name in Rust, in the kernels' paths and for people;
/// - `gpu`: whether it votes in a `subgroup` or its lanes are `alone`, and the type that follows rays;
/// - `persistent`: the type that persistent subgroups follow rays by, if it can go on with another ray at any step;
/// - `cpu`: how the CPU gives it rays, see `eyerays::cpu`, and the type that follows them.
#[macro_export]
macro_rules! for_each_method {
    ($then:ident $($with:tt)*) => {
        $then! { [$($with)*]
            /// Every ray by itself, one pair of boxes and one triangle at a time
            IfIf if_if "if-if": gpu(alone, IfIf), persistent(IfIf), cpu(alone, IfIf);
            /// Every ray by itself, pairs of boxes until it is at a leaf
            WhileWhile while_while "while-while":
                gpu(alone, WhileWhile<Alone>), persistent(WhileWhile<Subgroup>), cpu(alone, WhileWhile<Alone>);
            /// As while-while, but on past a leaf until every ray of a subgroup has one
            Speculative speculative "speculative":
                gpu(subgroup, Speculative<Subgroup>), persistent(), cpu(alone, Speculative<Alone>);
            /// Every ray by itself, through nodes of eight boxes: on a GPU quantised ones (CWBVH)
            Wide wide "wide": gpu(alone, CwbvhMethod), persistent(CwbvhMethod), cpu(nodes);
            /// The rays of a subgroup together, by votes
            Packet packet "packet": gpu(subgroup, Packet<Subgroup>), persistent(), cpu(together, Packet<Alone>);
            /// Together until a small stack is full, then each ray by itself
            SequentialStack sequential_stack "sequential-stack":
                gpu(subgroup, Hybrid<Subgroup, StackMax, Sequential>), persistent(),
                cpu(plainly, Hybrid<Alone, StackMax, Sequential>);
            /// Together where enough rays want a node, the others of it in the end by themselves
            SequentialCut sequential_cut "sequential-cut":
                gpu(subgroup, Hybrid<Subgroup, Cut, Sequential>), persistent(),
                cpu(plainly, Hybrid<Alone, Cut, Sequential>);
            /// Together until a small stack is full, each ray by itself below
            InterleavedStack interleaved_stack "interleaved-stack":
                gpu(subgroup, Hybrid<Subgroup, StackMax, Interleaved>), persistent(),
                cpu(plainly, Hybrid<Alone, StackMax, Interleaved>);
            /// Together where enough rays want a node, else each ray by itself below it
            InterleavedCut interleaved_cut "interleaved-cut":
                gpu(subgroup, Hybrid<Subgroup, Cut, Interleaved>), persistent(),
                cpu(plainly, Hybrid<Alone, Cut, Interleaved>);
        }
    };
}
