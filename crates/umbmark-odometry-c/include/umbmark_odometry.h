/* Corrected wheel odometry on the robot: the C edge of the crate umbmark-odometry.
 *
 *     #include "umbmark_odometry.h"
 *     #include "model.h"                  // umbmark export model.toml --to embedded -o model.h
 *
 *     static umbmark_odometer odometer;
 *     umbmark_begin(&odometer, umbmark_model, sizeof umbmark_model / sizeof *umbmark_model);
 *     for (;;) {
 *         umbmark_estimate now;
 *         if (umbmark_update(&odometer, seconds(), left_counter(), right_counter(), &now) == UMBMARK_OK) {
 *             use(now.x_m, now.y_m, now.heading_rad, now.covariance);
 *         }
 *     }
 *
 * An odometer is used by one thread at a time. Nothing is allocated.
 */
#ifndef UMBMARK_ODOMETRY_H
#define UMBMARK_ODOMETRY_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Size of an odometer. */
#define UMBMARK_ODOMETER_BYTES 4864

/* The state of one run. A static one is zero, which is a state that has not begun. */
typedef struct umbmark_odometer {
    uint64_t opaque[UMBMARK_ODOMETER_BYTES / 8];
} umbmark_odometer;

/* Where a run begins, and where it stands in its session. */
typedef struct umbmark_run {
    double x_m, y_m, heading_rad;
    /* Its number in the session, from 0, and the path length that was driven before it. */
    double number, session_distance_m;
    /* Its sense: 1 counter-clockwise, -1 clockwise, 0 where it has none. */
    double direction;
} umbmark_run;

/* Where the robot is. */
typedef struct umbmark_estimate {
    /* Time of the reading that the pose belongs to. */
    double time_s;
    /* The pose; the heading is counter-clockwise and keeps its full turns. */
    double x_m, y_m, heading_rad;
    /* xx, xy, yy [m^2], x heading, y heading [m rad], heading heading [rad^2]. */
    double covariance[6];
    /* 0 where the model has no noise; the covariance is zero then. */
    int covariance_known;
} umbmark_estimate;

typedef enum umbmark_status {
    UMBMARK_OK = 0,
    UMBMARK_NULL = 1,
    UMBMARK_NOT_BEGUN = 2,
    UMBMARK_NOT_A_TABLE = 3,
    UMBMARK_VERSION = 4,
    UMBMARK_LENGTH = 5,
    UMBMARK_NUMBER = 6,
    UMBMARK_LAW = 7,
    UMBMARK_TIME = 8,
    UMBMARK_COUNT = 9,
    UMBMARK_TOO_FAST = 10,
    UMBMARK_LOST = 11,
    UMBMARK_RUN = 12
} umbmark_status;

/* Begins a run at the START of the table with the first reading. The table is not copied: it must live as long as the odometer is used. */
umbmark_status umbmark_begin(umbmark_odometer *odometer, const double *table, size_t numbers);

/* The same elsewhere, or with other runs before it in its session. A null run is that of umbmark_begin. */
umbmark_status umbmark_begin_at(umbmark_odometer *odometer, const double *table, size_t numbers, const umbmark_run *run);

/* Takes a reading of both counters: left and right, or drive and steering. Counts are cumulative, whole or not; where counters roll over
 * they are what the counter shows. The time may begin anywhere.
 *
 * The estimate is of this reading, or, where the model depends on the speed of the wheels, of the last one that is 0.05 s old:
 * time_s says of which. out may be null. A reading that is refused changes nothing, and the next one may be given. */
umbmark_status umbmark_update(umbmark_odometer *odometer, double time_s, double first, double second, umbmark_estimate *out);

/* The pose of the newest reading, also where that of umbmark_update is older: speeds are those of the time that has passed. */
umbmark_status umbmark_ahead(umbmark_odometer *odometer, umbmark_estimate *out);

/* Path length that was driven in the session [m], for the next umbmark_run. */
double umbmark_session_distance(umbmark_odometer *odometer);

/* Counts of the first and the second counter per turn of its wheel (of a steering, about the vertical), from a table: for encoders that
 * tell angles, counts = angle / (2 pi) * counts per turn. */
umbmark_status umbmark_counts_per_turn(const double *table, size_t numbers, double out[2]);

/* A status in words. */
const char *umbmark_status_text(int status);

#ifdef __cplusplus
}
#endif

#endif
