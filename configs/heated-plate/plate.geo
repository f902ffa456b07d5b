// SPDX-License-Identifier: Apache-2.0
// Plate of 1 m x 0.25 m under the channel.
DefineConstant[ n = 40 ]; // cells along the plate
length = 1; depth = 0.25;

Point(1) = {0, -depth, 0}; Point(2) = {length, -depth, 0};
Point(3) = {length, 0, 0}; Point(4) = {0, 0, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1 : 4};
Plane Surface(1) = {1};
Transfinite Curve {1, 3} = n + 1 Using Bump 0.25;
Transfinite Curve {2} = Ceil(n / 3) + 1 Using Progression 1 / 1.08^(40 / n);
Transfinite Curve {4} = Ceil(n / 3) + 1 Using Progression 1.08^(40 / n);
Transfinite Surface {1};
Recombine Surface {1};
Physical Curve("bottom") = {1};
Physical Curve("ends") = {2, 4};
Physical Curve("surface") = {3};
Physical Surface("plate") = {1};
