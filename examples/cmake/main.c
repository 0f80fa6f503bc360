/* The law drives the plant until the second tank stands at its level. Both are written while this builds. */
#include "law.h"
#include "plant.h"
#include <stddef.h>
#include <stdio.h>

int main(void)
{
    double x[PLANT_STATES] = {0.1, 0.1}, u[PLANT_INPUTS], y[1];
    double gap = 1.0;
    int k;

    for (k = 0; k < 40; k++) {
        if (law(x, u) != LAW_INSIDE) {
            fprintf(stderr, "step %d: the state lies outside the law\n", k);
            return 2;
        }
        printf("%2d  h1 %6.4f  h2 %6.4f  q %6.4f  valve %g\n", k, x[0], x[1], u[0], u[1]);
        if (plant_step(x, u, x, y, NULL, NULL) != 0) {
            fprintf(stderr, "step %d: the plant has no step\n", k);
            return 3;
        }
        gap = x[1] - 0.3;
    }
    return gap < 0.05 && gap > -0.05 ? 0 : 1;
}
