/* A plant and its law in a loop: both were written by generate.py. */
#include "law.h"
#include "plant.h"
#include <stdio.h>

int main(void)
{
    double x[PLANT_STATES] = {-5.0, 0.0};
    double u[PLANT_INPUTS], y[PLANT_OUTPUTS] = {0.0};
    int k, status;

    for (k = 0; k < 30; k++) {
        if (law(x, u) != LAW_INSIDE) {
            fprintf(stderr, "step %d: the state is outside the map of the law\n", k);
            return 2;
        }
        printf("%2d  position %8.4f m  speed %8.4f m/s  force %8.4f N\n", k, x[0], x[1], u[0]);
        status = plant_step(x, u, x, y, NULL, NULL);
        if (status != 0) {
            fprintf(stderr, "step %d: the plant reports status %d\n", k, status);
            return 3;
        }
    }
    return y[0] > 0.5 ? 0 : 1; /* arrived */
}
