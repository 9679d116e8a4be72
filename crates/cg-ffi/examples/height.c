/* Replays a log through the estimator and prints the results. Runs on a host and, with mps2.ld and
 * startup.c, on an emulated Cortex-M4F.
 *
 * The log is an array of cg_sample, compiled in from the file LOG. The design is the file DESIGN from
 * `cg design --emit c`. Numbers are printed as their bits, so that two machines can be compared. */
#include <stdio.h>
#include <string.h>

#include "cg_height.h"
#include DESIGN

__asm__(".section .rodata\n"
        ".balign 8\n"
        "log_begin:\n"
        ".incbin \"" LOG "\"\n"
        "log_end:\n"
        ".text\n");
extern const cg_sample log_begin[];
extern const cg_sample log_end[];

static unsigned long bits(float value)
{
    uint32_t word;
    memcpy(&word, &value, sizeof word);
    return value != value ? 0x7fc00000u : word;
}

/* FNV-1a over bytes. */
static uint64_t hash_of(const void *data, size_t size)
{
    const unsigned char *bytes = data;
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t k = 0; k < size; k++)
        hash = (hash ^ bytes[k]) * 0x100000001b3u;
    return hash;
}

static void print_step(const cg_step *step)
{
    printf("maneuver %llu %llu %08lx %08lx", (unsigned long long)step->start_us,
           (unsigned long long)step->end_us, bits(step->speed_mps), bits(step->trailer_mass_kg));
    for (int place = 0; place < CG_CHANNELS; place++) {
        const cg_outcome *o = &step->outcomes[place];
        printf(" | %d %08lx %08lx %08lx %08lx %08lx %08lx %08lx", (int)o->reject,
               bits(o->ratio.value), bits(o->ratio.sd), bits(o->snr_db),
               bits(o->height_m.value), bits(o->height_m.sd), bits(o->systematic_sd_m),
               bits(o->road_sd_m));
    }
    printf("\n");
}

static void print_height(const cg_estimator *estimator, int32_t channel)
{
    cg_height height;
    if (cg_estimator_height(estimator, channel, &height) == CG_OK)
        printf("height %d: %08lx %08lx %08lx of %lu\n",
               (int)channel, bits(height.height_m.value), bits(height.height_m.sd),
               bits(height.random_sd_m), (unsigned long)height.maneuvers);
}

static int refused(void)
{
    static cg_estimator estimator; /* all zero: not initialized */
    cg_design broken = CG_DESIGN;
    cg_height height;
    int faults = 0;
    const cg_sample *sample = log_begin;

    faults += cg_estimator_push(NULL, sample, NULL) != CG_NULL_POINTER;
    faults += cg_estimator_push(&estimator, sample, NULL) != CG_NOT_INITIALISED;
    faults += cg_estimator_init(&estimator, 16, &CG_DESIGN, sizeof CG_DESIGN) != CG_WRONG_SIZE;
    faults += cg_estimator_init(&estimator, sizeof estimator, &CG_DESIGN, 12) != CG_WRONG_SIZE;
    faults += cg_estimator_init(&estimator, sizeof estimator, NULL, sizeof broken)
              != CG_NULL_POINTER;
    faults += cg_estimator_init((cg_estimator *)((char *)&estimator + 1), sizeof estimator,
                                &CG_DESIGN, sizeof CG_DESIGN)
              != CG_MISALIGNED;
    faults += cg_estimator_init_on_road(&estimator, sizeof estimator, &CG_DESIGN, sizeof CG_DESIGN,
                                        -0.01f)
              != CG_BAD_ROAD;
    broken.speed_mps[3] = NAN;
    faults += cg_estimator_init(&estimator, sizeof estimator, &broken, sizeof broken)
              != CG_BAD_DESIGN;
    faults += cg_estimator_height(&estimator, CG_COMBINED, &height) != CG_NOT_INITIALISED;
    faults += cg_estimator_init(&estimator, sizeof estimator, &CG_DESIGN, sizeof CG_DESIGN)
              != CG_OK;
    faults += cg_estimator_height(&estimator, CG_COMBINED, &height) != CG_NO_ANSWER;
    for (int32_t channel = CG_STEER; channel <= CG_TRACTOR + 1; channel++) {
        int known = channel == (int32_t)CG_DESIGN.channels[0].index
                    || channel == (int32_t)CG_DESIGN.channels[1].index;
        int expected = known ? CG_NO_ANSWER : CG_BAD_CHANNEL;
        faults += cg_estimator_height(&estimator, channel, &height) != expected;
    }
    faults += cg_estimator_push(&estimator, sample, NULL) != CG_OK;
    faults += cg_estimator_push(&estimator, sample, NULL) != CG_TIME_ORDER;
    return faults;
}

int main(void)
{
    static cg_estimator estimator;
    cg_step step;
    cg_rollover rollover;
    float mass_kg = CG_DESIGN.nominal_trailer_mass_kg;
    float speed_mps = CG_DESIGN.nominal_speed_mps;
    uint32_t turning = 0;

    printf("design %016llx\n", (unsigned long long)hash_of(&CG_DESIGN, sizeof CG_DESIGN));
    printf("refusals missed %d\n", refused());
    if (cg_estimator_init(&estimator, sizeof estimator, &CG_DESIGN, sizeof CG_DESIGN) != CG_OK)
        return 1;
    for (const cg_sample *sample = log_begin; sample != log_end; sample++) {
        if (cg_estimator_push(&estimator, sample, &step) != CG_OK)
            return 1;
        turning += step.status == CG_TURNING;
        mass_kg = sample->trailer_mass_kg;
        speed_mps = sample->speed_mps;
        if (step.closed)
            print_step(&step);
    }
    if (cg_estimator_finish(&estimator, &step) != CG_OK)
        return 1;
    if (step.closed)
        print_step(&step);
    printf("turning %lu\n", (unsigned long)turning);
    for (int place = 0; place < CG_CHANNELS; place++)
        print_height(&estimator, (int32_t)CG_DESIGN.channels[place].index);
    print_height(&estimator, CG_COMBINED);
    if (cg_estimator_threshold(&estimator, mass_kg, speed_mps, &rollover) == CG_OK)
        printf("threshold %08lx %08lx\n",
               bits(rollover.static_rollover_threshold_g.value),
               bits(rollover.static_rollover_threshold_g.sd));
    return 0;
}
