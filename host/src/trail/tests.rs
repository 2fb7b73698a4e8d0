//! The steps of rays among a few triangles, whose order a person can tell.

use eyerays_shader::data::{CentredPair, Frame, Launch, NodePair, NodeRef, Primitive, Specialisation, Tuning};
use eyerays_shader::scene::LaunchContext;
use glam::{Vec3, vec3};

use super::tape::Event;
use super::walk::{Trial, Witness};
use super::*;

/// Writes down what a lane does.
#[derive(Default)]
struct Diary {
    lane: usize,
    lines: Vec<String>,
    events: Vec<Event>,
}

impl Witness for Diary {
    fn event(&mut self, event: Event) {
        self.events.push(event);
    }

    fn visit(&mut self, lanes: u32, depth: u32, tell: impl Fn(usize) -> Visit) {
        if lanes >> self.lane & 1 == 0 {
            return;
        }
        let visit = tell(self.lane);
        assert_eq!(visit.depth, depth);
        let of = |child: &Child| match child.child {
            Target::Node(number) => format!("node {number} {:?}", child.fate),
            Target::Leaf { number, primitives } => format!("leaf {number}+{primitives} {:?}", child.fate),
            Target::Copy(number) => format!("copy {number} {:?}", child.fate),
        };
        let children: Vec<String> = visit.children.iter().map(of).collect();
        self.lines.push(format!("node {} at {depth}: {}", visit.node, children.join(", ")));
    }

    fn test(&mut self, lanes: u32, tell: impl Fn(usize) -> Trial) {
        if lanes >> self.lane & 1 == 1 {
            let Trial { primitive, met, is_closest } = tell(self.lane);
            let is_met = met.primitive_index != Hit::<f32>::NOTHING;
            let what = if is_closest {
                "closest"
            } else if is_met {
                "farther"
            } else {
                "miss"
            };
            self.lines.push(format!("triangle {primitive}: {what}"));
        }
    }
}

/// What a lane does by a method among four triangles in a row along x, whose rays start at zero. The root has the first two on the
/// left, in a pair of leaves, and the others on the right, in one leaf. What the kernel does is the same.
fn among(method: Method, tuning: Tuning, directions: impl Fn(usize) -> Vec3, lane: usize) -> (Vec<String>, Hit<f32>) {
    let wall = |x: f32| [vec3(x, -0.1, -0.1), vec3(x, 0.1, -0.1), vec3(x, 0.0, 0.1)];
    let triangles: Vec<Primitive> =
        [0.125, 0.25, 0.5, 0.75].iter().zip(0..).map(|(&x, i)| Primitive::triangle(wall(x), i, 0, 0)).collect();
    let around = |of: &[Primitive], node| {
        let bounds = of.iter().map(Primitive::bounds);
        let (least, greatest) = bounds.reduce(|(a, b), (c, d)| (a.min(c), b.max(d))).unwrap();
        (least, greatest, node)
    };
    let leaf = |first: usize, count: usize| {
        around(&triangles[first..first + count], NodeRef::leaf(first as u32, count as u32))
    };
    let nodes =
        [NodePair::new(around(&triangles[..2], NodeRef::inner(1)), leaf(2, 2)), NodePair::new(leaf(0, 1), leaf(1, 1))];
    let nodes: Vec<CentredPair> = nodes.iter().map(CentredPair::from).collect();
    let frame = Frame { slots: 32, ..Frame::default() };
    let spec = Specialisation { tuning, ..Specialisation::default() }.with_launch(Launch::STREAM);
    let context = TraceContext {
        base: LaunchContext::new(&frame, spec, bytemuck::cast_slice(&triangles), &[]),
        nodes: bytemuck::cast_slice(&nodes),
        wide: &[],
        bvh8: Default::default(),
        cutout: Default::default(),
    };
    let block = Block::along(directions);
    let mut diary = Diary { lane, ..Diary::default() };
    let hit = Walk::new(&context, &block, &mut diary).follow(method, lane);
    let (events, found) = tape::of(method, &context, &block, lane);
    assert_eq!(diary.events, events, "{method}: the kernel does something else");
    assert_eq!((hit.t, hit.primitive), (found.t, found.primitive), "{method}");
    (diary.lines, hit)
}

fn alone(method: Method, direction: Vec3) -> (Vec<String>, Hit<f32>) {
    among(method, Tuning::default(), |_| direction, 0)
}

/// Every second ray goes away from the triangles.
fn halves(lane: usize) -> Vec3 {
    if lane.is_multiple_of(2) { Vec3::X } else { -Vec3::X }
}

#[test]
fn a_ray_goes_to_the_nearer_child_first_and_back_to_what_it_has_pushed() {
    for method in [Method::IfIf, Method::WhileWhile, Method::Speculative] {
        let (lines, hit) = alone(method, Vec3::X);
        let want = [
            "node 0 at 0: node 1 Next, leaf 2+2 Pushed",
            "node 1 at 1: leaf 0+1 Next, leaf 1+1 Pushed",
            "triangle 0: closest",
            "triangle 1: farther",
            "triangle 2: farther",
            "triangle 3: farther",
        ];
        assert_eq!(lines, want, "{method}");
        assert_eq!((hit.t, hit.primitive), (0.125, 0));
    }
}

#[test]
fn a_ray_that_meets_no_box_visits_the_root_alone() {
    let (lines, hit) = alone(Method::IfIf, -Vec3::X);
    assert_eq!(lines, ["node 0 at 0: node 1 Missed, leaf 2+2 Missed"]);
    assert_eq!(hit.primitive, Hit::<f32>::NOTHING);
}

/// It meets the box of a triangle beside its upper corner.
#[test]
fn a_triangle_is_missed_where_its_box_is_met() {
    let (lines, _) = alone(Method::IfIf, vec3(0.125, 0.09, 0.09));
    assert_eq!(lines[2..], ["triangle 0: miss"]);
}

#[test]
fn a_ray_of_a_packet_goes_where_others_go() {
    let (lines, hit) = among(Method::Packet, Tuning::default(), halves, 1);
    assert_eq!(lines.len(), 6, "{lines:?}");
    assert_eq!(lines[2..], ["triangle 0: miss", "triangle 1: miss", "triangle 2: miss", "triangle 3: miss"]);
    assert_eq!(hit.primitive, Hit::<f32>::NOTHING);
}

/// At the pair on the left, while the leaf on the right waits.
#[test]
fn a_ray_that_has_left_its_packet_goes_its_own_way() {
    for method in [Method::SequentialStack, Method::InterleavedStack] {
        let (towards, _) = among(method, Tuning::new(1, 0), halves, 0);
        assert_eq!(towards.len(), 6, "{method}: {towards:?}");
        let (away, _) = among(method, Tuning::new(1, 0), halves, 1);
        let missed = "node 1 at 1: leaf 0+1 Missed, leaf 1+1 Missed".to_owned();
        assert_eq!(away[1], missed, "{method}");
        assert!(!away.contains(&"triangle 0: miss".to_owned()), "{method}: {away:?}");
    }
    for method in [Method::SequentialCut, Method::InterleavedCut] {
        let (towards, hit) = among(method, Tuning::new(63, 100), halves, 0);
        assert_eq!(towards[0], "node 0 at 0: node 1 Alone, leaf 2+2 Alone", "{method}");
        assert_eq!(hit.primitive, 0);
        let (away, _) = among(method, Tuning::new(63, 100), halves, 1);
        assert_eq!(away.len(), 1, "{method}: {away:?}");
    }
}

/// Packets that part at any time, of rays that go many ways.
#[test]
fn all_lanes_find_the_same_by_every_method() {
    let fan = |lane: usize| vec3(1.0, lane as f32 / 16.0 - 1.0, (lane % 5) as f32 / 20.0 - 0.1);
    let methods = Method::ALL.into_iter().filter(|&method| method != Method::Wide);
    let found: Vec<_> = methods
        .map(|method| {
            let tunings = [(1, 0), (2, 30), (63, 60), (63, 100)].map(|(stack, cut)| Tuning::new(stack, cut));
            let lanes = (0..block::LANES).map(|lane| tunings.map(|tuning| among(method, tuning, fan, lane).1));
            lanes.map(|hits| hits.map(|hit| (hit.t.to_bits(), hit.primitive))).collect::<Vec<_>>()
        })
        .collect();
    assert!(found.windows(2).all(|two| two[0] == two[1]));
    assert!(found[0].iter().any(|hits| hits[0].1 == 0) && found[0].iter().any(|hits| hits[0].1 != 0));
}
