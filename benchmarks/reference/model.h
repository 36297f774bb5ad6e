/* A model of rigid bodies and springs. The compiler is told its sizes and which bodies each spring joins:

   AXES     1, or 2 for plane motion (two coordinates and an angle for each body)
   MOVING   bodies that move; FIXED bodies follow them
   JOINTS   springs, with FIRST and SECOND, the lists of their bodies, and FACE, the list of those that are contacts with a face
   COLUMNS  parameters to which derivatives are taken; 0: none
   EXTENDED if defined, every number is a long double, to take differences of
*/
#include <math.h>
#include <string.h>

#ifdef EXTENDED
#include <tgmath.h>
#define double long double
#define LANDED 1e-18L            /* m or m s-1, of the guard at a crossing */
#define BEYOND 1e-16L            /* m, past the end of a branch, where the next one is looked up */
#define SHORTEST 1e-20L          /* s, of a step that is shortened to a crossing */
#else
#define LANDED 1e-14
#define BEYOND 1e-12
#define SHORTEST 1e-16
#endif

#define DOF (AXES == 1 ? 1 : 3)
#define N (DOF * MOVING)
#define ALL (DOF * (MOVING + FIXED))

enum { STIFFNESS, CRUSH_FORCE, DENSIFICATION, DENSE_STIFFNESS, UNLOADING, RATE, CLEARANCE, TENSION, PARAMETERS };

static const int first_body[] = FIRST, second_body[] = SECOND, is_face[] = FACE;

typedef struct {
    double inverse_mass[N];      /* kg-1, of an angle kg-1 m-2 */
    double start[2][ALL];        /* positions and velocities at t = 0 */
    double p[JOINTS][PARAMETERS];
    double places[JOINTS][6];    /* attachments in their bodies' frames, then the normal of the face (one axis: the side) */
    double rest[JOINTS];         /* free lengths */
} Model;

typedef struct {                 /* derivatives of the same to the parameters */
    double inverse_mass[N][COLUMNS];
    double start[2][ALL][COLUMNS];
    double p[JOINTS][PARAMETERS][COLUMNS];
    double rest[JOINTS][COLUMNS];
} Seeds;

typedef struct {
    double q[ALL], v[ALL], a[N];
    double d[JOINTS], w[JOINTS], f[JOINTS];
} State;

typedef struct {
    double q[ALL][COLUMNS], v[ALL][COLUMNS], a[N][COLUMNS];
    double d[JOINTS][COLUMNS], w[JOINTS][COLUMNS], f[JOINTS][COLUMNS];
} Tangent;
