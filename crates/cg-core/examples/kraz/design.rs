// Design of the vehicle "kraz", not calibrated.
// Make it again, do not edit it:
// cg design --vehicle fixtures/vehicles/kraz.toml --model complete --emit rust --channels steer,lateral-acceleration --output crates/cg-core/examples/kraz/design.rs

/// The constants of this truck.
#[allow(clippy::unreadable_literal)]
#[rustfmt::skip]
pub const DESIGN: cg_core::Design<f32, 2> = cg_core::Design {
    speed_mps: [3.0, 4.0, 5.5, 8.0, 13.889, 17.0, 23.0, 30.0],
    trailer_mass_kg: [8649.264, 12849.381, 18684.0, 26168.654, 34114.01, 42684.0],
    channels: [
        cg_core::ChannelDesign {
            index: 0,
            models: [
                cg_core::Reduced5 { numerator: [682.61115, 322.20718, 99.97682, 13.323645, 1.0852972, -0.028910398], denominator: [2874.695, 2742.5955, 1126.3715, 228.33707, 23.207443], speed_slope: [0.0, 0.0, 0.0, 0.0, 0.0] },
                cg_core::Reduced5 { numerator: [550.5176, 212.0595, 67.09634, 8.777398, 0.843111, -0.023838803], denominator: [1608.9484, 1599.306, 687.62103, 153.5605, 18.592192], speed_slope: [0.0, 0.0, 0.0, 0.0, 0.0] },
                cg_core::Reduced5 { numerator: [438.19128, 217.94994, 52.24755, 8.759359, 0.54010373, -0.016256515], denominator: [882.71313, 1061.075, 530.4108, 136.47891, 18.083], speed_slope: [0.0, 0.0, 0.0, 0.0, 0.0] },
                cg_core::Reduced5 { numerator: [989.8115, 257.24527, 63.422436, 7.3392687, 0.3865183, -0.0117300665], denominator: [1392.8688, 1442.5912, 633.1028, 147.00066, 18.48497], speed_slope: [0.0, 0.0, 0.0, 0.0, 0.0] },
                cg_core::Reduced5 { numerator: [1098.1738, 229.10611, 58.14313, 5.6413956, 0.33294827, -0.010006875], denominator: [1145.695, 1181.7561, 528.5195, 129.34958, 17.491217], speed_slope: [0.0, 0.0, 0.0, 0.0, 0.0] },
                cg_core::Reduced5 { numerator: [1147.7902, 207.10445, 53.682415, 4.4874177, 0.29586357, -0.008865363], denominator: [913.33765, 950.2043, 442.27145, 115.81114, 16.782377], speed_slope: [0.0, 0.0, 0.0, 0.0, 0.0] },
            ],
            friction: [
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
            ],
            of_lines: [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0],
            articulation: cg_core::Articulation { mean: -0.3, sd: 0.3 },
            lines: [
                [
                    cg_core::RatioLine { a0: 0.005384496, a1: 0.0049350453, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.0040628514, a1: 0.008293461, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.002150233, a1: 0.013163172, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: -0.000439052, a1: 0.019786617, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.0033658305, a1: 0.027313141, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.0067580957, a1: 0.036106482, b0: 1.3232992, b1: -0.19017601 },
                ],
                [
                    cg_core::RatioLine { a0: 0.00961422, a1: 0.008748085, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.0073494827, a1: 0.014702174, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.004065997, a1: 0.023336787, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: -0.00038797685, a1: 0.035084274, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.0054354123, a1: 0.048434325, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.011299015, a1: 0.06403675, b0: 1.3232992, b1: -0.19017601 },
                ],
                [
                    cg_core::RatioLine { a0: 0.018149707, a1: 0.016442716, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.013982931, a1: 0.027636956, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.007933541, a1: 0.043875277, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: -0.00028482292, a1: 0.065980166, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.009616422, a1: 0.091103755, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.020476658, a1: 0.12048654, b0: 1.3232992, b1: -0.19017601 },
                ],
                [
                    cg_core::RatioLine { a0: 0.037972912, a1: 0.034313075, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.029394427, a1: 0.05768835, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.016923837, a1: 0.09161801, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: -4.4812277e-5, a1: 0.13786636, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.019350596, a1: 0.19044617, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.041864622, a1: 0.25203952, b0: 1.3232992, b1: -0.19017601 },
                ],
                [
                    cg_core::RatioLine { a0: 0.10895184, a1: 0.098299645, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.08464194, a1: 0.16541733, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.049208038, a1: 0.26306242, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: 0.000819661, a1: 0.39678696, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.054482374, a1: 0.5489847, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.11929793, a1: 0.7283159, b0: 1.3232992, b1: -0.19017601 },
                ],
                [
                    cg_core::RatioLine { a0: 0.15745208, a1: 0.14202197, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.12245151, a1: 0.23914348, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.07135249, a1: 0.3806599, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: 0.0014149795, a1: 0.57509226, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.07874076, a1: 0.79655445, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.1729873, a1: 1.0585482, b0: 1.3232992, b1: -0.19017601 },
                ],
                [
                    cg_core::RatioLine { a0: 0.2647238, a1: 0.23872602, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.20624757, a1: 0.4025402, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.12057654, a1: 0.6420629, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: 0.0027452125, a1: 0.9735137, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.13313822, a1: 1.3517096, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.2940457, a1: 1.8031535, b0: 1.3232992, b1: -0.19017601 },
                ],
                [
                    cg_core::RatioLine { a0: 0.3999263, a1: 0.3606093, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.31219614, a1: 0.6091329, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.18310331, a1: 0.97410977, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: 0.004448843, a1: 1.4837725, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.20319587, a1: 2.0666852, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.45132282, a1: 2.7705326, b0: 1.3232992, b1: -0.19017601 },
                ],
            ],
            compensation: 1.0,
        },
        cg_core::ChannelDesign {
            index: 1,
            models: [
                cg_core::Reduced5 { numerator: [18.008928, 16.390352, 6.7666826, 1.5661354, 0.121481314, 0.0032641736], denominator: [2874.695, 2742.5955, 1126.3715, 228.33707, 23.207443], speed_slope: [4.1751842, 4.040891, -0.022108125, -0.016116364, 0.0] },
                cg_core::Reduced5 { numerator: [14.528298, 12.142285, 4.7361984, 1.0420951, 0.117407724, 0.0035245316], denominator: [1608.9484, 1599.306, 687.62103, 153.5605, 18.592192], speed_slope: [2.4516585, 2.0832658, 0.089480996, -0.022751097, 0.0] },
                cg_core::Reduced5 { numerator: [11.577627, 11.128714, 4.5499177, 0.96288246, 0.1301585, 0.00384624], denominator: [882.71313, 1061.075, 530.4108, 136.47891, 18.083], speed_slope: [1.3917007, 1.403761, 0.20589988, -0.03228197, 0.0] },
                cg_core::Reduced5 { numerator: [26.182875, 19.410448, 6.2970634, 1.1198176, 0.14463323, 0.004275709], denominator: [1392.8688, 1442.5912, 633.1028, 147.00066, 18.48497], speed_slope: [2.3728693, 1.9035884, 0.1430231, -0.012133291, 0.0] },
                cg_core::Reduced5 { numerator: [29.153944, 20.403114, 6.420086, 1.0936519, 0.14434588, 0.005151913], denominator: [1145.695, 1181.7561, 528.5195, 129.34958, 17.491217], speed_slope: [2.200856, 1.5458664, 0.2168885, -0.0006707899, 0.0] },
                cg_core::Reduced5 { numerator: [30.551283, 20.766737, 6.658198, 1.1101638, 0.1362581, 0.0066488897], denominator: [913.33765, 950.2043, 442.27145, 115.81114, 16.782377], speed_slope: [1.9713229, 1.303711, 0.28014648, 0.01727412, 0.0] },
            ],
            friction: [
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
                cg_core::Friction {
                    usual_share: 0.0,
                    bend: 0.0,
                    knee_rad: 0.0,
                    roll_rad: 0.0,
                    deflection_rad: 0.0,
                },
            ],
            of_lines: [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0],
            articulation: cg_core::Articulation { mean: 0.15614815, sd: 0.16857296 },
            lines: [
                [
                    cg_core::RatioLine { a0: 0.0028295694, a1: 0.0025933816, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.0021385513, a1: 0.004365405, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.0011353756, a1: 0.006950477, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: -0.00023289847, a1: 0.010495961, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.0017960031, a1: 0.014574259, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.0036284898, a1: 0.019385934, b0: 1.3232992, b1: -0.19017601 },
                ],
                [
                    cg_core::RatioLine { a0: 0.0028501481, a1: 0.0025933816, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.0021822262, a1: 0.004365405, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.0012109901, a1: 0.006950477, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: -0.000116068804, a1: 0.010495961, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.0016355572, a1: 0.014574259, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.003420567, a1: 0.019385934, b0: 1.3232992, b1: -0.19017601 },
                ],
                [
                    cg_core::RatioLine { a0: 0.002862612, a1: 0.0025933816, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.0022086788, a1: 0.004365405, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.0012567873, a1: 0.006950477, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: -4.530892e-5, a1: 0.010495961, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.0015383803, a1: 0.014574259, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.0032946349, a1: 0.019385934, b0: 1.3232992, b1: -0.19017601 },
                ],
                [
                    cg_core::RatioLine { a0: 0.002869992, a1: 0.0025933816, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.0022243413, a1: 0.004365405, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.0012839042, a1: 0.006950477, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: -3.411622e-6, a1: 0.010495961, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.0014808414, a1: 0.014574259, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.0032200697, a1: 0.019385934, b0: 1.3232992, b1: -0.19017601 },
                ],
                [
                    cg_core::RatioLine { a0: 0.002874412, a1: 0.0025933816, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.0022337222, a1: 0.004365405, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.0013001453, a1: 0.006950477, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: 2.1681988e-5, a1: 0.010495961, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.0014463796, a1: 0.014574259, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.0031754104, a1: 0.019385934, b0: 1.3232992, b1: -0.19017601 },
                ],
                [
                    cg_core::RatioLine { a0: 0.0028751418, a1: 0.0025933816, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.0022352708, a1: 0.004365405, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.0013028265, a1: 0.006950477, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: 2.5824671e-5, a1: 0.010495961, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.0014406902, a1: 0.014574259, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.0031680376, a1: 0.019385934, b0: 1.3232992, b1: -0.19017601 },
                ],
                [
                    cg_core::RatioLine { a0: 0.0028758063, a1: 0.0025933816, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.0022366813, a1: 0.004365405, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.0013052684, a1: 0.006950477, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: 2.9597571e-5, a1: 0.010495961, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.0014355088, a1: 0.014574259, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.003161323, a1: 0.019385934, b0: 1.3232992, b1: -0.19017601 },
                ],
                [
                    cg_core::RatioLine { a0: 0.0028761362, a1: 0.0025933816, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.0022373814, a1: 0.004365405, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.0013064805, a1: 0.006950477, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: 3.147038e-5, a1: 0.010495961, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.0014329369, a1: 0.014574259, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.0031579898, a1: 0.019385934, b0: 1.3232992, b1: -0.19017601 },
                ],
            ],
            compensation: 1.0,
        },
    ],
    spread: [
        [
            cg_core::Spread {
                covariance: [
                    [0.012820462, 0.00996172],
                    [0.00996172, 0.010187187],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.011700471, 0.00878096],
                    [0.00878096, 0.009013423],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.0112073505, 0.00820891],
                    [0.00820891, 0.008449491],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.01123976, 0.008153743],
                    [0.008153743, 0.008401381],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.011617367, 0.0084505305],
                    [0.0084505305, 0.008702693],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.012242844, 0.009002999],
                    [0.009002999, 0.009256346],
                ],
            },
        ],
        [
            cg_core::Spread {
                covariance: [
                    [0.012831518, 0.009791409],
                    [0.009791409, 0.010003348],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.0117040165, 0.008587199],
                    [0.008587199, 0.00880323],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.011216573, 0.008002556],
                    [0.008002556, 0.0082236165],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.011260166, 0.007940341],
                    [0.007940341, 0.00816567],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.01164903, 0.0082334755],
                    [0.0082334755, 0.008461726],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.012283828, 0.00878345],
                    [0.00878345, 0.009012473],
                ],
            },
        ],
        [
            cg_core::Spread {
                covariance: [
                    [0.013215788, 0.009698813],
                    [0.009698813, 0.009902615],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.012103319, 0.008482446],
                    [0.008482446, 0.00868859],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.011641177, 0.007891673],
                    [0.007891673, 0.008101019],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.011713375, 0.007826065],
                    [0.007826065, 0.0080379825],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.012126984, 0.0081170965],
                    [0.0081170965, 0.008331005],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.012782868, 0.008665155],
                    [0.008665155, 0.008879556],
                ],
            },
        ],
        [
            cg_core::Spread {
                covariance: [
                    [0.01492888, 0.009647654],
                    [0.009647654, 0.009846704],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.013866256, 0.00842484],
                    [0.00842484, 0.008625137],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.013466241, 0.007830927],
                    [0.007830927, 0.0080333715],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.013605233, 0.0077636847],
                    [0.0077636847, 0.007967608],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.0140743535, 0.008053455],
                    [0.008053455, 0.008258881],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.014782008, 0.00860031],
                    [0.00860031, 0.008805979],
                ],
            },
        ],
        [
            cg_core::Spread {
                covariance: [
                    [0.02889374, 0.009618124],
                    [0.009618124, 0.009814538],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.02800153, 0.008391961],
                    [0.008391961, 0.008588693],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.027806792, 0.0077962866],
                    [0.0077962866, 0.007994592],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.028202387, 0.0077285543],
                    [0.0077285543, 0.007927294],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.028860325, 0.008017359],
                    [0.008017359, 0.008217533],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.02980815, 0.008563794],
                    [0.008563794, 0.008763707],
                ],
            },
        ],
        [
            cg_core::Spread {
                covariance: [
                    [0.045365423, 0.009613216],
                    [0.009613216, 0.009809323],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.04459394, 0.008386689],
                    [0.008386689, 0.0085827885],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.044555325, 0.0077907024],
                    [0.0077907024, 0.007988315],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.04520398, 0.0077231447],
                    [0.0077231447, 0.007920769],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.046023536, 0.008011652],
                    [0.008011652, 0.00821084],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.047250547, 0.008558237],
                    [0.008558237, 0.008756857],
                ],
            },
        ],
        [
            cg_core::Spread {
                covariance: [
                    [0.10174482, 0.009608549],
                    [0.009608549, 0.009804596],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.10136655, 0.008381993],
                    [0.008381993, 0.008577438],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.101891145, 0.0077856663],
                    [0.0077856663, 0.007982628],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.10363484, 0.0077187023],
                    [0.0077187023, 0.00791486],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.1051191, 0.0080066975],
                    [0.0080066975, 0.008204776],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.10764163, 0.008553816],
                    [0.008553816, 0.00875065],
                ],
            },
        ],
        [
            cg_core::Spread {
                covariance: [
                    [0.21193126, 0.009605955],
                    [0.009605955, 0.009802259],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.21259393, 0.008379772],
                    [0.008379772, 0.008574792],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.2147034, 0.007783203],
                    [0.007783203, 0.007979816],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.2197043, 0.0077171074],
                    [0.0077171074, 0.007911937],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.22321284, 0.00800453],
                    [0.00800453, 0.008201777],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.22967431, 0.008552452],
                    [0.008552452, 0.0087475795],
                ],
            },
        ],
    ],
    nominal_speed_mps: 13.889,
    nominal_trailer_mass_kg: 18684.0,
    reference_height_m: 1.7,
    least_height_m: 1.0,
    greatest_height_m: 3.0,
    trailer_wheelbase_m: 7.59,
    gravity_mps2: 9.81,
    rollover: cg_core::RolloverDesign { half_track_m: 0.99269533, unsprung_mass_kg: 2184.0, unsprung_height_m: 0.507 },
    thresholds: [
        cg_core::ThresholdLine {
            threshold_g: [
                [0.86984783, 0.75856155, 0.6798225, 0.6179487, 0.5667748, 0.52389383, 0.48635358, 0.4535665],
                [0.8086102, 0.7326258, 0.6685027, 0.6141317, 0.5673175, 0.5258376, 0.4892917, 0.45676517],
            ],
        },
        cg_core::ThresholdLine {
            threshold_g: [
                [0.9192144, 0.7589655, 0.6558103, 0.57990384, 0.5195578, 0.46980962, 0.4276152, 0.39119145],
                [0.8349244, 0.730092, 0.6463226, 0.577906, 0.5207233, 0.47232154, 0.43066195, 0.3943347],
            ],
        },
        cg_core::ThresholdLine {
            threshold_g: [
                [0.9958192, 0.75836587, 0.6328623, 0.5454156, 0.47807154, 0.42351547, 0.37824434, 0.33974218],
                [0.84209836, 0.7257412, 0.6243771, 0.5445759, 0.4799206, 0.42647082, 0.38137662, 0.34269366],
            ],
        },
        cg_core::ThresholdLine {
            threshold_g: [
                [1.1824322, 0.75274426, 0.6106094, 0.51462746, 0.44213426, 0.3844159, 0.33695722, 0.2983835],
                [0.86603445, 0.7199643, 0.6038154, 0.51503724, 0.44488096, 0.3875882, 0.3401168, 0.30086797],
            ],
        },
        cg_core::ThresholdLine {
            threshold_g: [
                [1.0810901, 0.7430857, 0.5908813, 0.48942563, 0.414381, 0.35640362, 0.30919883, 0.26978636],
                [0.888378, 0.71395177, 0.58659333, 0.4914017, 0.41704512, 0.3585963, 0.31077212, 0.270966],
            ],
        },
        cg_core::ThresholdLine {
            threshold_g: [
                [1.0686496, 0.7316765, 0.57258844, 0.46792465, 0.38998455, 0.32866436, 0.27888262, 0.23754393],
                [0.89710236, 0.70398134, 0.56767946, 0.467909, 0.3913393, 0.33004642, 0.27965882, 0.23783778],
            ],
        },
    ],
};
