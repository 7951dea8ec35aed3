//! tmp
mod problems; mod solvers; mod runs; mod scope; mod stopwatch;
fn main() {
    let scope = if std::env::args().any(|a| a == "--quick") { scope::Scope::Quick } else { scope::Scope::Full };
    for p in problems::all() {
        let t = stopwatch::start();
        let d = runs::diagram(&*p, scope);
        println!("== {} {:.1}s", d.card.title, t.seconds());
        for s in &d.series {
            println!("  {} ({})", s.who.name(), s.ended);
            for r in &s.runs {
                match &r.outcome { Ok(p) => println!("     {:?} err {:.1e} t {:.2e} ev {} jac {}", r.effort, p.error, p.seconds, p.evaluations, p.jacobians), Err(e) => println!("     {:?} FAILED {e}", r.effort) }
            }
        }
    }
}
