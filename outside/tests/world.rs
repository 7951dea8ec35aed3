//! The crate is used as a stranger would.

#[test]
fn a_ball_falls_bounces_and_is_where_it_should_be() {
    let height = outside::height_after_a_second().expect("a world");
    let fall = (2.0_f64 * 2.0 / 9.81).sqrt();
    let since = 1.0 - fall;
    let exact = 0.5 + 9.81 * fall * since - 0.5 * 9.81 * since * since;
    assert!((height - exact).abs() < 1e-9, "{height}, not {exact}");
}
