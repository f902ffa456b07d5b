// SPDX-License-Identifier: Apache-2.0
// Half a channel of 5 x 0.5 m under a wall, quadrilaterals: 50 along it as the wall's own faces.
n_along = 50; n_up = 12;
Point(1) = {0, 0, 0}; Point(2) = {5, 0, 0}; Point(3) = {5, 0.5, 0}; Point(4) = {0, 0.5, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Transfinite Curve {1, 3} = n_along + 1;
Transfinite Curve {2} = n_up + 1 Using Progression 1 / 1.15;
Transfinite Curve {4} = n_up + 1 Using Progression 1.15;
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Surface {1};
Recombine Surface {1};
Physical Curve("bottom") = {1};
Physical Curve("ends") = {2, 4};
Physical Curve("wall") = {3};
Physical Surface("fluid") = {1};
