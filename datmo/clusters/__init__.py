"""Clusters: elevated points that belong together."""

from datmo.clusters.config import ClusterConfig, MergeConfig, SplitConfig
from datmo.clusters.label import cluster
from datmo.clusters.merge import merge_clusters
from datmo.clusters.split import split_clusters

__all__ = ["ClusterConfig", "MergeConfig", "SplitConfig", "cluster", "merge_clusters", "split_clusters"]
