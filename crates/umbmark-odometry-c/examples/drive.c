/* Corrects the odometry of a log as a robot would: reading by reading.
 *
 *     umbmark export model.toml --to embedded -o model.h
 *     cargo build --release -p umbmark-odometry-c
 *     cc -I. -Icrates/umbmark-odometry-c/include crates/umbmark-odometry-c/examples/drive.c \
 *         target/release/libumbmark_odometry_c.a -lm -o drive
 *     ./drive < log.csv
 *
 * The log has the columns t_s, ticks_left and ticks_right, in this order.
 */
#include <stdio.h>

#include "model.h"
#include "umbmark_odometry.h"

#define NUMBERS (sizeof umbmark_model / sizeof *umbmark_model)

static void print(const umbmark_estimate *at)
{
    printf("%.17g,%.17g,%.17g,%.17g", at->time_s, at->x_m, at->y_m, at->heading_rad);
    for (int i = 0; at->covariance_known && i < 6; i++) {
        printf(",%.17g", at->covariance[i]);
    }
    printf("\n");
}

int main(void)
{
    static umbmark_odometer odometer;
    umbmark_status status = umbmark_begin(&odometer, umbmark_model, NUMBERS);
    if (status != UMBMARK_OK) {
        fprintf(stderr, "model.h: %s\n", umbmark_status_text(status));
        return 1;
    }
    char line[256];
    if (fgets(line, sizeof line, stdin) == NULL) {
        fprintf(stderr, "no log on standard input\n");
        return 1;
    }
    umbmark_estimate at = {0};
    double printed = -1e300;
    while (fgets(line, sizeof line, stdin) != NULL) {
        double time, first, second;
        if (sscanf(line, "%lf,%lf,%lf", &time, &first, &second) != 3) {
            fprintf(stderr, "not a row of the log: %s", line);
            return 1;
        }
        status = umbmark_update(&odometer, time, first, second, &at);
        if (status != UMBMARK_OK) {
            fprintf(stderr, "at %g s: %s\n", time, umbmark_status_text(status));
        } else if (at.time_s > printed) {
            print(&at);
            printed = at.time_s;
        }
    }
    /* The run ends here, so what was final only later is final now. */
    if (umbmark_ahead(&odometer, &at) == UMBMARK_OK && at.time_s > printed) {
        print(&at);
    }
    return 0;
}
