/* umbmark 0.1.0: E_d 1.001124743, E_b 0.992341079, E_s 1.0 */
/* no covariances: the model has no [noise]; learn or fit it on tick logs, which show it */
#ifndef UMBMARK_ODOMETRY_H
#define UMBMARK_ODOMETRY_H

#define UMBMARK_WHEELBASE_M 0.337395967 /* b: distance of the two wheels' contact points */
#define UMBMARK_WHEEL_DIAMETER_LEFT_M 0.149915692 /* diameter of the left wheel */
#define UMBMARK_WHEEL_DIAMETER_RIGHT_M 0.150084308 /* diameter of the right wheel */
#define UMBMARK_METRES_PER_TICK_LEFT 2.354870178661e-4
#define UMBMARK_METRES_PER_TICK_RIGHT 2.357518801724e-4

#endif
