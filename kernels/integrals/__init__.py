"""Motion as integrals over the tilt: passages, periods and contact forces by quadrature."""
