// SPDX-License-Identifier: Apache-2.0
DefineConstant[ n = 4 ];
Point(1) = {0,0,0}; l[] = Extrude {1,0,0} { Point{1}; Layers{n}; Recombine; };
s[] = Extrude {0,1,0} { Curve{l[1]}; Layers{n}; Recombine; };
v[] = Extrude {0,0,1} { Surface{s[1]}; Layers{n}; Recombine; };
Physical Volume("b") = {v[1]};
Physical Surface("z0") = {s[1]}; Physical Surface("z1") = {v[0]}; Physical Surface("y0") = {v[2]}; Physical Surface("x1") = {v[3]}; Physical Surface("y1") = {v[4]}; Physical Surface("x0") = {v[5]};
