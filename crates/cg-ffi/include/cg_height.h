/* Center-of-gravity height of a semitrailer, sample by sample.
 *
 * One estimator serves one truck. It uses no heap, no globals and no locks; the caller provides the
 * memory. Units are SI. Axes are those of ISO 8855: in a left turn steer angle, yaw rate, lateral
 * acceleration and roll angle are positive. An absent signal is NAN.
 *
 *     cg_estimator estimator;
 *     if (cg_estimator_init(&estimator, sizeof estimator, &CG_DESIGN, sizeof CG_DESIGN) != CG_OK) ...
 *     for each sample:
 *         cg_estimator_push(&estimator, &sample, NULL);
 *     cg_height height;
 *     if (cg_estimator_height(&estimator, CG_COMBINED, &height) == CG_OK) ...
 *
 * `cg design --vehicle truck.toml --emit c -o truck.h` writes CG_DESIGN.
 *
 * Every function returns CG_OK (0) or another value of enum cg_error; on an error it has written
 * nothing. An estimator may be used by one thread at a time and may be copied with memcpy.
 */
#ifndef CG_HEIGHT_H
#define CG_HEIGHT_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Sizes of the tables of a design. */
#define CG_SPEEDS 8
#define CG_MASSES 6
#define CG_STEPS 3
#define CG_SPRING_MASSES ((CG_MASSES - 1) * CG_STEPS + 1)
#define CG_HEIGHTS 8
#define CG_ORDER 5
#define CG_CHANNELS 2

/* The reduced model of one channel at one mass, in ascending powers of s; s^5 has the coefficient 1. */
typedef struct cg_reduced_model {
    float numerator[CG_ORDER + 1];
    float denominator[CG_ORDER];
    /* Change of the numerator (from s^1 on) per unit of U0/U - 1, with the speed U and the design's
     * nominal speed U0. */
    float speed_slope[CG_ORDER];
} cg_reduced_model;

/* The friction and bends of the springs in the roll angle at one mass; all zero without friction. */
typedef struct cg_friction {
    float usual_share, bend, knee_rad, roll_rad, deflection_rad;
} cg_friction;

/* Relative change of a ratio by the articulation angle, divided by its square: 1/rad^2. */
typedef struct cg_articulation {
    float mean, sd;
} cg_articulation;

/* DC ratio over height: (a1 h + a0) / (b1 h + b0). */
typedef struct cg_ratio_line {
    float a0, a1, b0, b1;
} cg_ratio_line;

/* The lead of the trailer's lateral acceleration over yaw rate times speed U: ahead_m/U - slip_s2_per_m U, in seconds. */
typedef struct cg_path_lead {
    float ahead_m, slip_s2_per_m;
} cg_path_lead;

typedef struct cg_channel_design {
    /* enum cg_channel. */
    uint32_t index;
    cg_reduced_model models[CG_MASSES];
    /* At the masses of the axis and CG_STEPS equal steps between two of them. */
    cg_friction friction[CG_SPRING_MASSES];
    /* The ratio at these masses over that of the interpolated lines. */
    float of_lines[CG_SPRING_MASSES];
    cg_articulation articulation;
    cg_ratio_line lines[CG_SPEEDS][CG_MASSES];
    float compensation;
} cg_channel_design;

/* Covariance of the logarithms of the channels' ratios. */
typedef struct cg_spread {
    float covariance[CG_CHANNELS][CG_CHANNELS];
} cg_spread;

typedef struct cg_rollover_design {
    float half_track_m;
    float unsprung_mass_kg;
    float unsprung_height_m;
    float payload_beside_sd_m;
    /* At 30 km/h; it grows with the square of the speed. */
    float tightest_turn_g;
} cg_rollover_design;

/* Rollover thresholds at one mass in steady turns at 40 and at 90 km/h, for heights evenly spaced
 * from the least to the greatest. */
typedef struct cg_threshold_line {
    float threshold_g[2][CG_HEIGHTS];
} cg_threshold_line;

/* The constants of one truck, with two channels chosen for its sensors. Do not write them by hand. Keep them in flash; the estimator reads them
 * there. */
typedef struct cg_design {
    float speed_mps[CG_SPEEDS];
    float trailer_mass_kg[CG_MASSES];
    cg_channel_design channels[CG_CHANNELS];
    cg_spread spread[CG_SPEEDS][CG_MASSES];
    float nominal_speed_mps;
    float nominal_trailer_mass_kg;
    float reference_height_m;
    float least_height_m;
    float greatest_height_m;
    float trailer_wheelbase_m;
    cg_path_lead path_lead;
    float gravity_mps2;
    cg_rollover_design rollover;
    cg_threshold_line thresholds[CG_MASSES];
} cg_design;

/* Size of an estimator in bytes. */
#define CG_ESTIMATOR_SIZE 5208

/* An estimator in memory of the caller, static or on a stack. Its contents are private. */
typedef struct cg_estimator {
    uint64_t opaque[CG_ESTIMATOR_SIZE / 8];
} cg_estimator;

/* Return values. */
enum cg_error {
    CG_OK = 0,
    /* A pointer that must not be NULL is NULL. */
    CG_NULL_POINTER = 1,
    /* A pointer is not aligned for its type. */
    CG_MISALIGNED = 2,
    /* A size differs from that of the type: header and library are of different versions. */
    CG_WRONG_SIZE = 3,
    /* The design is invalid: a number is not finite, an axis does not increase, a model is unstable, or
       a channel is unknown or occurs twice. */
    CG_BAD_DESIGN = 4,
    /* The estimator was not initialized. */
    CG_NOT_INITIALISED = 5,
    /* Time does not increase; the sample was not used. */
    CG_TIME_ORDER = 6,
    /* No maneuver has given a height yet, or the mass is outside the design. */
    CG_NO_ANSWER = 7,
    /* There is no such channel, or the design does not have it. */
    CG_BAD_CHANNEL = 8,
    /* The bank of the road is negative or not finite. */
    CG_BAD_ROAD = 9
};

/* A channel: the roll angle and the input from which a height is identified. */
enum cg_channel {
    /* Both channels of the design, weighted by their uncertainty. */
    CG_COMBINED = -1,
    /* Roll angle by steer angle. */
    CG_STEER = 0,
    /* Roll angle by lateral acceleration, or by yaw rate times speed. */
    CG_LATERAL_ACCELERATION = 1,
    /* Suspension roll of the trailer by its specific force; does not depend on the bank of the road. */
    CG_SUSPENSION = 2,
    /* The same for the tractor; needs no sensor on the trailer. */
    CG_TRACTOR = 3
};

/* The state that a sample shows. */
enum cg_status {
    /* No roll angle or no input in this sample. */
    CG_ABSENT = 0,
    CG_STRAIGHT = 1,
    CG_TURNING = 2
};

/* Why a maneuver gave no height in a channel. */
enum cg_reject {
    CG_ACCEPTED = 0,
    /* The channel's signal was absent. */
    CG_REJECT_ABSENT = 1,
    /* The data do not determine the ratio: too short, or the input hardly moved. */
    CG_REJECT_UNEXCITED = 2,
    /* The ratio is uncertain by more than 20 %. */
    CG_REJECT_IMPRECISE = 3,
    /* Speed or trailer mass are not covered by the design. */
    CG_REJECT_OUTSIDE_DESIGN = 4,
    /* No physically possible height explains the ratio. */
    CG_REJECT_HEIGHT = 5,
    /* The roll angle stood still, or the model does not explain it: check the sensors. */
    CG_REJECT_INCONSISTENT = 6
};

/* One row of sensor values; CG_NO_SIGNALS is a row without signals. */
typedef struct cg_sample {
    /* Microseconds from any origin, strictly increasing. Use the time of sampling, not of arrival:
       an interval that differs from the last one costs ten times the instructions. */
    uint64_t time_us;
    /* Mean road-wheel angle of the steered axle, rad, positive to the left. */
    float steer_rad;
    /* Roll angle of the trailer's sprung mass to the road, rad, positive right side down. */
    float roll_rad;
    /* Roll angle of the trailer's sprung mass to gravity (roll plus the bank of the road), rad, positive
       right side down; used if roll_rad is NAN. */
    float roll_to_gravity_rad;
    /* Angle of an accelerometer-type inclinometer on the trailer's body, rad: its lateral specific
       force divided by g; used if lateral_specific_force_mps2 is NAN. */
    float tilt_rad;
    /* Roll angle of the trailer's sprung mass to its axles, rad, positive right side down. */
    float suspension_roll_rad;
    /* Forward speed, m/s; while it is NAN the last known speed is used. */
    float speed_mps;
    /* Lateral acceleration of the trailer's sprung mass, m/s^2, positive to the left. */
    float lateral_acceleration_mps2;
    /* Reading of an accelerometer fixed to the trailer's body, along its lateral axis, gravity
       included, m/s^2, positive to the left. */
    float lateral_specific_force_mps2;
    /* Roll angle of the tractor's sprung mass to its drive axles, rad, positive right side down. */
    float tractor_suspension_roll_rad;
    /* Reading of an accelerometer fixed to the tractor's body, as above, m/s^2, positive to the left
       (in J1939: VDC2). */
    float tractor_lateral_specific_force_mps2;
    /* Angle of an accelerometer-type inclinometer on the tractor's body, rad; used if
       tractor_lateral_specific_force_mps2 is NAN. */
    float tractor_tilt_rad;
    /* Yaw rate of the trailer, rad/s, positive to the left; multiplied by speed it replaces an absent
       lateral acceleration. */
    float yaw_rate_radps;
    /* Mass of the whole semitrailer as weighed, kg; while it is NAN the last known mass is used, and
       before the first one the nominal mass of the design. It counts as exact: no standard deviation
       of a height contains that of the mass, and a height at the nominal mass of a trailer with
       another load is wrong by as much as that load differs, and more. */
    float trailer_mass_kg;
} cg_sample;

#define CG_NO_SIGNALS(time) \
    {(time), NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN}

/* A value and its standard deviation. */
typedef struct cg_measured {
    float value;
    float sd;
} cg_measured;

/* Result of one channel for a maneuver. */
typedef struct cg_outcome {
    /* enum cg_reject. */
    int32_t reject;
    /* DC ratio, rad of roll per rad (or per m/s^2); NAN if there is none. */
    cg_measured ratio;
    /* Signal-to-noise ratio, dB; NAN if there is none. */
    float snr_db;
    /* Height with the standard deviation due to noise and to this curve's own bank; NAN if rejected. */
    cg_measured height_m;
    /* Standard deviation of the height due to calibration, model and the bank that all curves have in
       common. */
    float systematic_sd_m;
    /* Standard deviation of the height due to the bank of the road, contained in the other two. */
    float road_sd_m;
} cg_outcome;

/* Result of a sample. */
typedef struct cg_step {
    /* enum cg_status. */
    int32_t status;
    /* 1 if the sample ended a maneuver (after cg_estimator_lighten, its solution), which the following
       fields describe; otherwise 0, and these fields are zero. */
    int32_t closed;
    uint64_t start_us;
    uint64_t end_us;
    /* Means over the maneuver. */
    float speed_mps;
    float trailer_mass_kg;
    /* In the order of the design's channels. */
    cg_outcome outcomes[CG_CHANNELS];
} cg_step;

/* Height of the c.g. of the trailer's sprung mass above ground at rest. */
typedef struct cg_height {
    cg_measured height_m;
    /* The part of the standard deviation that more maneuvers would reduce. */
    float random_sd_m;
    uint32_t maneuvers;
} cg_height;

/* Lateral accelerations, in g. */
typedef struct cg_rollover {
    /* Half the track divided by the height of the whole trailer's c.g. */
    float static_stability_factor_g;
    /* Lateral acceleration at which the vehicle tips in a steady turn. */
    cg_measured static_rollover_threshold_g;
} cg_rollover;

/* Constructs an estimator in `estimator`. The design is read in place as long as the estimator is
 * used; it must not move or change.
 * Errors: CG_NULL_POINTER, CG_MISALIGNED, CG_WRONG_SIZE, CG_BAD_DESIGN. */
int32_t cg_estimator_init(cg_estimator *estimator, size_t estimator_size, const cg_design *design,
                          size_t design_size);

/* The same for roads whose bank in curves has this standard deviation, rad: 0 for a flat test track. The
 * function above assumes public roads for roll angles to gravity, and for trucks with a channel that does
 * not depend on the bank; otherwise a roll angle to the road is taken to come from a flat test track.
 * Errors: as above, CG_BAD_ROAD. */
int32_t cg_estimator_init_on_road(cg_estimator *estimator, size_t estimator_size,
                                  const cg_design *design, size_t design_size, float bank_sd_rad);

/* For a small microcontroller, after one of the functions above: the solution at the end of a maneuver is spread
 * over the next samples, two of its eleven stages each. Its result comes up to a tenth of a second later at 100 samples per second, and
 * these samples are in no maneuver. Heights differ by less than their noise.
 * Errors: CG_NULL_POINTER, CG_MISALIGNED, CG_NOT_INITIALISED. */
int32_t cg_estimator_lighten(cg_estimator *estimator);

/* Processes a sample. `step` may be NULL.
 * Errors: CG_NULL_POINTER, CG_MISALIGNED, CG_NOT_INITIALISED, CG_TIME_ORDER. */
int32_t cg_estimator_push(cg_estimator *estimator, const cg_sample *sample, cg_step *step);

/* Ends the log: closes the open maneuver, if there is one. `step` may be NULL; its status is
 * CG_ABSENT. More samples may follow.
 * Errors: CG_NULL_POINTER, CG_MISALIGNED, CG_NOT_INITIALISED. */
int32_t cg_estimator_finish(cg_estimator *estimator, cg_step *step);

/* The height so far. `channel` is an enum cg_channel.
 * Errors: CG_NULL_POINTER, CG_MISALIGNED, CG_NOT_INITIALISED, CG_BAD_CHANNEL, CG_NO_ANSWER. */
int32_t cg_estimator_height(const cg_estimator *estimator, int32_t channel, cg_height *height);

/* The rollover threshold at the combined height, for a trailer of this mass in a steady turn at this
 * speed (NAN: the lower of the thresholds at 40 and 90 km/h).
 * Errors: CG_NULL_POINTER, CG_MISALIGNED, CG_NOT_INITIALISED, CG_NO_ANSWER. */
int32_t cg_estimator_threshold(const cg_estimator *estimator, float trailer_mass_kg,
                               float speed_mps, cg_rollover *rollover);

#ifdef __cplusplus
}
#endif

#endif
