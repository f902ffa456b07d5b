// SPDX-License-Identifier: Apache-2.0
// The plate's mid-surface: x runs up from the root, y across. Quadrilaterals, half as long as the fluid's.
DefineConstant[ n = 20 ]; // cells along height and width
Point(1) = {0, -0.5, 0};
Point(2) = {1, -0.5, 0};
Point(3) = {1, 0.5, 0};
Point(4) = {0, 0.5, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Transfinite Curve {1 : 4} = n + 1;
Curve Loop(1) = {1 : 4};
Plane Surface(1) = {1};
Transfinite Surface {1};
Recombine Surface {1};
Physical Curve("root") = {4};
Physical Curve("edge") = {1, 2, 3};
Physical Surface("plate") = {1};
