// SPDX-License-Identifier: Apache-2.0
// A square plate a hundred times wider than thick: n cells a side, m through the thickness.
SetFactory("OpenCASCADE");
DefineConstant[ n = {16, Name "n"}, m = {2, Name "m"} ];
Rectangle(1) = {0, 0, 0, 1, 1};
Transfinite Curve {1:4} = n + 1; Transfinite Surface {1}; Recombine Surface {1};
Extrude {0, 0, 0.01} { Surface{1}; Layers{m}; Recombine; }
Physical Volume("plate") = {1};
Physical Surface("all") = {1:6};
Mesh.MshFileVersion = 4.1;
