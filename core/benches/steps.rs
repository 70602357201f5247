//! Makes a number of steps of one case, for a profiler: `steps CASE STEPS`. Without arguments it lists the cases.

mod cases;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let mut cases = cases::cases();
    let [case, steps] = arguments.as_slice() else {
        for case in &cases {
            println!("{}", case.name);
        }
        return;
    };
    let case = cases.iter_mut().find(|c| c.name == *case).expect("the first argument is a case");
    case.run(steps.parse().expect("the second argument is a number"));
}
