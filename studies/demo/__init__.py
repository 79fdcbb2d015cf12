"""The main job on real input: robots film, a medium that is too small carries, an operator watches."""
