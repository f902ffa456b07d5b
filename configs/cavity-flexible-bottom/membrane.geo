// SPDX-License-Identifier: Apache-2.0
// The flexible bottom, 2 mm thick.
DefineConstant[ n = 32, n_thick = 2 ];
h = 0.002;
Point(1) = {0, -h, 0}; Point(2) = {1, -h, 0}; Point(3) = {1, 0, 0}; Point(4) = {0, 0, 0};
For i In {1 : 4}
  Line(i) = {i, i % 4 + 1};
EndFor
Transfinite Curve {1, 3} = n + 1;
Transfinite Curve {2, 4} = n_thick + 1;
Curve Loop(1) = {1 : 4};
Plane Surface(1) = {1};
Transfinite Surface {1};
Recombine Surface {1};
Physical Curve("dry") = {1};
Physical Curve("ends") = {2, 4};
Physical Curve("wet") = {3};
Physical Surface("membrane") = {1};
