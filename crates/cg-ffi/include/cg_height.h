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
#define CG_HEIGHTS 8
#define CG_ORDER 5

/* The reduced model of one channel at one mass, in ascending powers of s; s^5 has the coefficient 1. */
typedef struct cg_reduced_model {
    float numerator[CG_ORDER + 1];
    float denominator[CG_ORDER];
} cg_reduced_model;

/* DC ratio over height: (a1 h + a0) / (b1 h + b0). */
typedef struct cg_ratio_line {
    float a0, a1, b0, b1;
} cg_ratio_line;

typedef struct cg_channel_design {
    cg_reduced_model models[CG_MASSES];
    cg_ratio_line lines[CG_SPEEDS][CG_MASSES];
    float compensation;
} cg_channel_design;

/* Relative standard deviations of both channels' ratios, and their correlation. */
typedef struct cg_spread {
    float sd[2];
    float correlation;
} cg_spread;

typedef struct cg_rollover_design {
    float half_track_m;
    float unsprung_mass_kg;
    float unsprung_height_m;
} cg_rollover_design;

/* Rollover thresholds at one mass in steady turns at 40 and at 90 km/h, for heights evenly spaced
 * from the least to the greatest. */
typedef struct cg_threshold_line {
    float threshold_g[2][CG_HEIGHTS];
} cg_threshold_line;

/* The constants of one truck. Do not write them by hand. Keep them in flash; the estimator reads them
 * there. */
typedef struct cg_design {
    float speed_mps[CG_SPEEDS];
    float trailer_mass_kg[CG_MASSES];
    cg_channel_design channels[2];
    cg_spread spread[CG_SPEEDS][CG_MASSES];
    float nominal_speed_mps;
    float nominal_trailer_mass_kg;
    float reference_height_m;
    float least_height_m;
    float greatest_height_m;
    float gravity_mps2;
    cg_rollover_design rollover;
    cg_threshold_line thresholds[CG_MASSES];
} cg_design;

/* Size of an estimator in bytes. */
#define CG_ESTIMATOR_SIZE 4064

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
    /* The design is invalid: a number is not finite, an axis does not increase, or a model is
       unstable. */
    CG_BAD_DESIGN = 4,
    /* The estimator was not initialized. */
    CG_NOT_INITIALISED = 5,
    /* Time does not increase; the sample was not used. */
    CG_TIME_ORDER = 6,
    /* No maneuver has given a height yet, or the mass is outside the design. */
    CG_NO_ANSWER = 7,
    /* There is no such channel. */
    CG_BAD_CHANNEL = 8
};

/* The input that causes the roll angle. */
enum cg_channel {
    CG_STEER = 0,
    CG_LATERAL_ACCELERATION = 1,
    /* Both, weighted by their uncertainty. */
    CG_COMBINED = 2
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
    /* Mean road-wheel angle of the steered axle. */
    float steer_rad;
    /* Roll angle of the trailer's sprung mass to the road. */
    float roll_rad;
    /* Angle of an inclinometer, which also feels lateral acceleration; used if roll_rad is NAN. */
    float tilt_rad;
    /* Forward speed; while it is NAN the last known speed is used. */
    float speed_mps;
    /* Lateral acceleration of the trailer's sprung mass. */
    float lateral_acceleration_mps2;
    /* Yaw rate of the trailer; multiplied by speed it replaces an absent lateral acceleration. */
    float yaw_rate_radps;
    /* Mass of the whole semitrailer as weighed; while it is NAN the last known mass is used. */
    float trailer_mass_kg;
} cg_sample;

#define CG_NO_SIGNALS(time) {(time), NAN, NAN, NAN, NAN, NAN, NAN, NAN}

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
    /* Height with the standard deviation due to noise; NAN if rejected. */
    cg_measured height_m;
    /* Standard deviation of the height due to calibration and model. */
    float systematic_sd_m;
} cg_outcome;

/* Result of a sample. */
typedef struct cg_step {
    /* enum cg_status. */
    int32_t status;
    /* 1 if the sample ended a maneuver, which the following fields describe; otherwise 0, and these
       fields are zero. */
    int32_t closed;
    uint64_t start_us;
    uint64_t end_us;
    /* Means over the maneuver. */
    float speed_mps;
    float trailer_mass_kg;
    /* Indexed by CG_STEER and CG_LATERAL_ACCELERATION. */
    cg_outcome outcomes[2];
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
