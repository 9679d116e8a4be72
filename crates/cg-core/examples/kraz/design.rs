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
                cg_core::Reduced5 { numerator: [579.5938, 275.48422, 89.135666, 12.254606, 1.0666394, -0.028656388], denominator: [2458.2908, 2397.7866, 1027.2192, 218.20728, 22.989532], speed_slope: [0.0, 0.0, 0.0, 0.0, 0.0] },
                cg_core::Reduced5 { numerator: [512.76245, 197.86356, 63.765633, 8.515272, 0.8160666, -0.023652101], denominator: [1508.5258, 1529.1289, 678.74066, 155.2236, 18.834948], speed_slope: [0.0, 0.0, 0.0, 0.0, 0.0] },
                cg_core::Reduced5 { numerator: [400.63577, 182.6278, 47.30541, 7.690607, 0.55961597, -0.017185882], denominator: [811.97107, 958.6405, 483.24118, 127.04856, 17.413206], speed_slope: [0.0, 0.0, 0.0, 0.0, 0.0] },
                cg_core::Reduced5 { numerator: [853.6944, 222.70827, 57.303097, 6.8260612, 0.38734308, -0.012160696], denominator: [1209.7859, 1278.915, 582.4659, 139.775, 18.034136], speed_slope: [0.0, 0.0, 0.0, 0.0, 0.0] },
                cg_core::Reduced5 { numerator: [956.9431, 197.0471, 52.99152, 5.192841, 0.3345042, -0.010432954], denominator: [1005.0949, 1055.9647, 488.4108, 122.55257, 16.95071], speed_slope: [0.0, 0.0, 0.0, 0.0, 0.0] },
                cg_core::Reduced5 { numerator: [1000.19543, 177.55733, 48.61718, 4.087361, 0.29511085, -0.009153354], denominator: [801.63495, 850.4337, 407.236, 108.74263, 16.137335], speed_slope: [0.0, 0.0, 0.0, 0.0, 0.0] },
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
                    cg_core::RatioLine { a0: 0.0053887726, a1: 0.0049325535, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.004074772, a1: 0.008289436, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.0021728012, a1: 0.013157267, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: -0.00040166004, a1: 0.019773008, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.0033139, a1: 0.027296785, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.006713732, a1: 0.036109902, b0: 1.3232992, b1: -0.19017601 },
                ],
                [
                    cg_core::RatioLine { a0: 0.009613992, a1: 0.00874128, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.0073581776, a1: 0.0146913305, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.0040869317, a1: 0.023320915, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: -0.00035045, a1: 0.03505103, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.0053809145, a1: 0.048393168, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.011251696, a1: 0.06402382, b0: 1.3232992, b1: -0.19017601 },
                ],
                [
                    cg_core::RatioLine { a0: 0.018133365, a1: 0.016420873, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.01398007, a1: 0.027602514, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.007948478, a1: 0.04382495, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: -0.00024710482, a1: 0.06588306, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.009553573, a1: 0.09098019, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.020415155, a1: 0.12039009, b0: 1.3232992, b1: -0.19017601 },
                ],
                [
                    cg_core::RatioLine { a0: 0.037882976, a1: 0.034223706, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.029338725, a1: 0.057548396, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.016910898, a1: 0.091413595, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: -7.068374e-6, a1: 0.13749562, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.019251931, a1: 0.18996364, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.04172753, a1: 0.25148678, b0: 1.3232992, b1: -0.19017601 },
                ],
                [
                    cg_core::RatioLine { a0: 0.10818634, a1: 0.09759705, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.08409987, a1: 0.16432016, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.048935264, a1: 0.26145655, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: 0.00085266837, a1: 0.3939898, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.054065052, a1: 0.54527354, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.11839281, a1: 0.7230702, b0: 1.3232992, b1: -0.19017601 },
                ],
                [
                    cg_core::RatioLine { a0: 0.15585779, a1: 0.14056937, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.12131114, a1: 0.23687369, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.070758104, a1: 0.37733144, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: 0.0014403668, a1: 0.56932396, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.077931724, a1: 0.7888618, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.17109932, a1: 1.0472784, b0: 1.3232992, b1: -0.19017601 },
                ],
                [
                    cg_core::RatioLine { a0: 0.26025292, a1: 0.23467396, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.2030228, a1: 0.39619282, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.11885451, a1: 0.6327137, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: 0.0027409075, a1: 0.9573277, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.1309479, a1: 1.3299558, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.2886102, a1: 1.7701112, b0: 1.3232992, b1: -0.19017601 },
                ],
                [
                    cg_core::RatioLine { a0: 0.38982004, a1: 0.35146925, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.3048652, a1: 0.5947623, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.17914096, a1: 0.95282257, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: 0.0043814145, a1: 1.4467572, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.1982198, a1: 2.016547, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.43858144, a1: 2.6926143, b0: 1.3232992, b1: -0.19017601 },
                ],
            ],
            compensation: 1.0,
        },
        cg_core::ChannelDesign {
            index: 1,
            models: [
                cg_core::Reduced5 { numerator: [15.401161, 14.3603, 6.225406, 1.5237498, 0.13484128, 0.0028535859], denominator: [2458.2908, 2397.7866, 1027.2192, 218.20728, 22.989532], speed_slope: [3.5706675, 3.444696, 0.07322818, -0.033650115, 0.0] },
                cg_core::Reduced5 { numerator: [13.622284, 11.653554, 4.746886, 1.073206, 0.12755926, 0.003259372], denominator: [1508.5258, 1529.1289, 678.74066, 155.2236, 18.834948], speed_slope: [2.2616694, 1.9944319, 0.11079559, -0.031305168, 0.0] },
                cg_core::Reduced5 { numerator: [10.6503725, 10.001413, 4.2113733, 0.91557294, 0.13283502, 0.0037631365], denominator: [811.97107, 958.6405, 483.24118, 127.04856, 17.413206], speed_slope: [1.3296443, 1.2028421, 0.2204196, -0.03469484, 0.0] },
                cg_core::Reduced5 { numerator: [22.742577, 17.339924, 5.987767, 1.0832019, 0.14983548, 0.004084083], denominator: [1209.7859, 1278.915, 582.4659, 139.775, 18.034136], speed_slope: [2.0537062, 1.6774982, 0.16535796, -0.019094763, 0.0] },
                cg_core::Reduced5 { numerator: [25.577503, 18.388493, 6.139242, 1.050941, 0.14879277, 0.004946912], denominator: [1005.0949, 1055.9647, 488.4108, 122.55257, 16.95071], speed_slope: [1.9255987, 1.3811197, 0.22250324, -0.005738745, 0.0] },
                cg_core::Reduced5 { numerator: [26.815825, 18.782246, 6.305797, 1.0595329, 0.13892218, 0.0064962883], denominator: [801.63495, 850.4337, 407.236, 108.74263, 16.137335], speed_slope: [1.7306201, 1.1700683, 0.27286914, 0.013570827, 0.0] },
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
            articulation: cg_core::Articulation { mean: 0.15617718, sd: 0.16925088 },
            lines: [
                [
                    cg_core::RatioLine { a0: 0.002833247, a1: 0.0025933816, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.002145867, a1: 0.004365405, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.0011478071, a1: 0.006950477, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: -0.00021321025, a1: 0.010495961, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.0017693525, a1: 0.014574259, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.003604329, a1: 0.019385934, b0: 1.3232992, b1: -0.19017601 },
                ],
                [
                    cg_core::RatioLine { a0: 0.0028522995, a1: 0.0025933816, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.0021864204, a1: 0.004365405, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.0012180536, a1: 0.006950477, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: -0.000104941544, a1: 0.010495961, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.0016205355, a1: 0.014574259, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.0034069293, a1: 0.019385934, b0: 1.3232992, b1: -0.19017601 },
                ],
                [
                    cg_core::RatioLine { a0: 0.002863839, a1: 0.0025933816, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.0022109824, a1: 0.004365405, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.0012605996, a1: 0.006950477, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: -3.9366754e-5, a1: 0.010495961, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.0015304019, a1: 0.014574259, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.0032873708, a1: 0.019385934, b0: 1.3232992, b1: -0.19017601 },
                ],
                [
                    cg_core::RatioLine { a0: 0.0028706715, a1: 0.0025933816, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.0022255254, a1: 0.004365405, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.0012857913, a1: 0.006950477, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: -5.3957626e-7, a1: 0.010495961, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.0014770334, a1: 0.014574259, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.0032165796, a1: 0.019385934, b0: 1.3232992, b1: -0.19017601 },
                ],
                [
                    cg_core::RatioLine { a0: 0.0028747637, a1: 0.0025933816, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.0022342359, a1: 0.004365405, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.0013008794, a1: 0.006950477, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: 2.2715243e-5, a1: 0.010495961, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.0014450692, a1: 0.014574259, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.0031741804, a1: 0.019385934, b0: 1.3232992, b1: -0.19017601 },
                ],
                [
                    cg_core::RatioLine { a0: 0.0028754394, a1: 0.0025933816, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.0022356738, a1: 0.004365405, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.0013033702, a1: 0.006950477, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: 2.655436e-5, a1: 0.010495961, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.0014397923, a1: 0.014574259, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.0031671808, a1: 0.019385934, b0: 1.3232992, b1: -0.19017601 },
                ],
                [
                    cg_core::RatioLine { a0: 0.0028760545, a1: 0.0025933816, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.0022369835, a1: 0.004365405, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.0013056388, a1: 0.006950477, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: 3.0050793e-5, a1: 0.010495961, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.0014349864, a1: 0.014574259, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.0031608061, a1: 0.019385934, b0: 1.3232992, b1: -0.19017601 },
                ],
                [
                    cg_core::RatioLine { a0: 0.00287636, a1: 0.0025933816, b0: 1.0432498, b1: -0.025441073 },
                    cg_core::RatioLine { a0: 0.0022376336, a1: 0.004365405, b0: 1.0728018, b1: -0.042824622 },
                    cg_core::RatioLine { a0: 0.0013067649, a1: 0.006950477, b0: 1.1159132, b1: -0.06818418 },
                    cg_core::RatioLine { a0: 3.1786367e-5, a1: 0.010495961, b0: 1.1750411, b1: -0.10296537 },
                    cg_core::RatioLine { a0: -0.0014326008, a1: 0.014574259, b0: 1.2430549, b1: -0.14297348 },
                    cg_core::RatioLine { a0: -0.0031576417, a1: 0.019385934, b0: 1.3232992, b1: -0.19017601 },
                ],
            ],
            compensation: 1.0,
        },
    ],
    spread: [
        [
            cg_core::Spread {
                covariance: [
                    [0.01583196, 0.01295879],
                    [0.01295879, 0.013181967],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.01470948, 0.011773955],
                    [0.011773955, 0.012003482],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.01421564, 0.011199282],
                    [0.011199282, 0.011436274],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.014247473, 0.011142133],
                    [0.011142133, 0.011385191],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.014626992, 0.01143814],
                    [0.01143814, 0.011685508],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.01527145, 0.011998476],
                    [0.011998476, 0.012249026],
                ],
            },
        ],
        [
            cg_core::Spread {
                covariance: [
                    [0.015872154, 0.01280247],
                    [0.01280247, 0.01301306],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.014745352, 0.011596536],
                    [0.011596536, 0.011810828],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.014259924, 0.011010875],
                    [0.011010875, 0.011229814],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.014304714, 0.010947932],
                    [0.010947932, 0.011170543],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.014697686, 0.0112407245],
                    [0.0112407245, 0.011466135],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.015351474, 0.011794322],
                    [0.011794322, 0.012021636],
                ],
            },
        ],
        [
            cg_core::Spread {
                covariance: [
                    [0.01631221, 0.012716947],
                    [0.012716947, 0.01291997],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.015203842, 0.011499925],
                    [0.011499925, 0.011705045],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.014747407, 0.010908807],
                    [0.010908807, 0.011116904],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.014822779, 0.010842995],
                    [0.010842995, 0.011053299],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.015244994, 0.011133894],
                    [0.011133894, 0.011346123],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.015925659, 0.011683603],
                    [0.011683603, 0.011896936],
                ],
            },
        ],
        [
            cg_core::Spread {
                covariance: [
                    [0.0152016645, 0.009644483],
                    [0.009644483, 0.009843094],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.014151069, 0.00842153],
                    [0.00842153, 0.008621225],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.013766564, 0.007827569],
                    [0.007827569, 0.008029278],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.013911783, 0.0077603604],
                    [0.0077603604, 0.007963313],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.014403071, 0.008050103],
                    [0.008050103, 0.008254526],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.01515349, 0.0085976515],
                    [0.0085976515, 0.008802618],
                ],
            },
        ],
        [
            cg_core::Spread {
                covariance: [
                    [0.030725121, 0.009616972],
                    [0.009616972, 0.009813172],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.029902752, 0.008390953],
                    [0.008390953, 0.008587342],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.029795408, 0.0077953744],
                    [0.0077953744, 0.007993258],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.03019172, 0.0077278116],
                    [0.0077278116, 0.007925949],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.030967403, 0.008016638],
                    [0.008016638, 0.008216205],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.0320333, 0.008563282],
                    [0.008563282, 0.0087626865],
                ],
            },
        ],
        [
            cg_core::Spread {
                covariance: [
                    [0.04888615, 0.009612371],
                    [0.009612371, 0.009808314],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.0482642, 0.008386042],
                    [0.008386042, 0.008581844],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.04840977, 0.0077901715],
                    [0.0077901715, 0.007987417],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.04903286, 0.0077228146],
                    [0.0077228146, 0.007919892],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.050087262, 0.008011348],
                    [0.008011348, 0.00820999],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.05147481, 0.008558078],
                    [0.008558078, 0.008756207],
                ],
            },
        ],
        [
            cg_core::Spread {
                covariance: [
                    [0.11017704, 0.009607964],
                    [0.009607964, 0.009803911],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.11029251, 0.008381661],
                    [0.008381661, 0.008576862],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.11141012, 0.007785471],
                    [0.007785471, 0.0079821255],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.11295485, 0.0077187475],
                    [0.0077187475, 0.007914403],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.11511727, 0.008006769],
                    [0.008006769, 0.008204359],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.117769115, 0.0085539855],
                    [0.0085539855, 0.008750334],
                ],
            },
        ],
        [
            cg_core::Spread {
                covariance: [
                    [0.22733311, 0.009605481],
                    [0.009605481, 0.009801731],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.22935589, 0.008379582],
                    [0.008379582, 0.008574396],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.23306726, 0.0077831624],
                    [0.0077831624, 0.007979508],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.23724867, 0.0077173314],
                    [0.0077173314, 0.007911688],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.24240844, 0.0080047855],
                    [0.0080047855, 0.008201572],
                ],
            },
            cg_core::Spread {
                covariance: [
                    [0.24839027, 0.008552782],
                    [0.008552782, 0.008747429],
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
    path_lead: cg_core::PathLead { ahead_m: 1.8624907, slip_s2_per_m: 0.014580103 },
    gravity_mps2: 9.81,
    rollover: cg_core::RolloverDesign {
        half_track_m: 0.99269533,
        unsprung_mass_kg: 2184.0,
        unsprung_height_m: 0.507,
        payload_beside_sd_m: 0.0,
        tightest_turn_g: 0.5684961,
    },
    thresholds: [
        cg_core::ThresholdLine {
            threshold_g: [
                [0.8718342, 0.79522014, 0.7107974, 0.645761, 0.5919105, 0.54565865, 0.50498784, 0.4688165],
                [0.8538046, 0.77545583, 0.7076293, 0.64908844, 0.5979745, 0.5527242, 0.5122855, 0.47583747],
            ],
        },
        cg_core::ThresholdLine {
            threshold_g: [
                [0.8587073, 0.756065, 0.6538736, 0.57718825, 0.5151436, 0.46294755, 0.42171708, 0.38619685],
                [0.844229, 0.7398547, 0.6530806, 0.5814513, 0.52088416, 0.4688662, 0.42506933, 0.38947272],
            ],
        },
        cg_core::ThresholdLine {
            threshold_g: [
                [0.83894515, 0.7373134, 0.62026227, 0.5366555, 0.47146717, 0.41839567, 0.37401202, 0.33626574],
                [0.8311775, 0.71485615, 0.61573386, 0.53765, 0.4743323, 0.42174977, 0.37738585, 0.33931705],
            ],
        },
        cg_core::ThresholdLine {
            threshold_g: [
                [0.82671064, 0.7359666, 0.6017578, 0.5090378, 0.43822157, 0.3816847, 0.33614972, 0.2983487],
                [0.8174612, 0.71363777, 0.59890884, 0.51124257, 0.44171852, 0.3850566, 0.3389872, 0.30056748],
            ],
        },
        cg_core::ThresholdLine {
            threshold_g: [
                [0.8289771, 0.73347515, 0.58856744, 0.49025735, 0.41654438, 0.35832542, 0.3108149, 0.27116838],
                [0.8148736, 0.7136262, 0.58609736, 0.49174464, 0.41857728, 0.3601387, 0.3122007, 0.27223152],
            ],
        },
        cg_core::ThresholdLine {
            threshold_g: [
                [0.83062804, 0.7323496, 0.5764505, 0.4717229, 0.39329985, 0.33160388, 0.2814662, 0.23973008],
                [0.8122894, 0.70390487, 0.57000387, 0.47110832, 0.3945971, 0.33272767, 0.28211752, 0.23992],
            ],
        },
    ],
};
