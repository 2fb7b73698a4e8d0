use eyerays_passes::Kernels;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let old = std::fs::read(&a[1]).unwrap(); let new = std::fs::read(&a[2]).unwrap();
    let (old, new) = (Kernels::parse(&old).unwrap(), Kernels::parse(&new).unwrap());
    // effects, launch, layout
    let specs = [(0u32,0u32,0u32),(1<<9,0,0),(1<<9|1|1<<2|1<<3|1<<10,0,4),(1<<9|1<<13|1<<0,1<<5|1<<10,0),(1<<13|1<<11|1<<3|1<<2,1|1<<10|1<<4,4),(1<<9|1<<6|1<<2,1<<11|1<<10,0),(1<<12,1<<6|1<<5,0)];
    for name in old.names() {
        let mut differ = 0; let mut line = String::new();
        for (e,l,y) in specs {
            let c = [(1,e),(2,(8|25<<8)|40<<16),(3,l),(4,y),(5,0)];
            let (o, n) = (old.cut(&name,&c).unwrap(), new.cut(&name,&c).unwrap());
            if o.instructions() != n.instructions() || o.bindings() != n.bindings() { differ += 1; line += &format!(" [{e:#x},{l:#x},{y}]: {} -> {} {:?}", o.instructions(), n.instructions(), o.bindings()==n.bindings()); }
        }
        if differ > 0 { println!("{name}: {differ} differ{line}"); }
    }
}
